// Files that hold motion: BVH, AMC, and glTF with its animations.
#ifndef CLIENT_CLI_MOTION_MOTION_FILE_H_
#define CLIENT_CLI_MOTION_MOTION_FILE_H_

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cli/bvh_clip.h"
#include "gelenk/motion/motion_clip.h"

namespace gelenk::cli {

struct MotionFileOptions {
  // Metres per unit; unset means guessed of BVH, 1 of glTF.
  std::optional<double> unit_m = std::nullopt;
  // Of glTF, by name or by index; empty means the first.
  std::string animation = {};
  // Of AMC: the ASF file that it moves.
  std::string skeleton_path = {};
};

// --animation NAME|INDEX
void AddAnimationOption(CLI::App& app, const std::string& name,
                        std::string* animation);
// --skeleton FILE.asf
void AddSkeletonOption(CLI::App& app, std::string* path);

struct MotionFile {
  MotionClip clip;
  // What a BVH file's own form, or that of an AMC file as BVH, is written back
  // into.
  std::optional<BvhClip> form = std::nullopt;
  double unit_m = 1;
  // Of glTF, in order; empty names as the file has them.
  std::vector<std::string> animation_names = {};
  // Which of them this is.
  int animation_index = 0;
  // Of a VRM file: which of its joints are the humanoid's bones, as it says.
  std::vector<std::pair<std::string, std::string>> joint_of_bone = {};
  std::vector<std::string> warnings = {};
};

// The motion of an AMC file. INVALID_ARGUMENT without its skeleton.
absl::StatusOr<BvhClip> ReadAmcClip(const std::string& path,
                                    const MotionFileOptions& options);

// Reads a .bvh, .amc, .gltf or .glb; buffers of a .gltf may be files in its
// folder. Errors name the file; INVALID_ARGUMENT for one without motion, or
// without that animation, naming those that there are.
absl::StatusOr<MotionFile> ReadMotionFile(
    const std::string& path, const MotionFileOptions& options = {});

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MOTION_MOTION_FILE_H_
