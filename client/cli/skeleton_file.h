// The one door for files that hold a skeleton.
#ifndef CLIENT_CLI_SKELETON_FILE_H_
#define CLIENT_CLI_SKELETON_FILE_H_

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cli/bvh_clip.h"
#include "gelenk/import/gltf_document.h"
#include "gelenk/import/gltf_import.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/v1/skeleton.pb.h"

namespace gelenk::cli {

struct SkeletonFile {
  std::string path;
  std::shared_ptr<const Skeleton> skeleton;
  // The same as a message, with display name and warnings.
  v1::Skeleton message;
  // Of a BVH file, and of an ASF file as of one without frames.
  std::optional<BvhClip> clip;
  // Of a VRM file: which of its joints are the humanoid's bones, as it says.
  std::vector<std::pair<std::string, std::string>> joint_of_bone;
};

// Reads what the name's end says: `.bvh`, `.asf`, `.urdf`, `.gltf`, `.glb`, or
// `.json`: proto3 JSON of gelenk.v1.Skeleton. `unit_m` is for BVH, ASF and
// glTF, `skin` for glTF; elsewhere they are refused. Errors name the file and
// the place in it.
absl::StatusOr<SkeletonFile> ReadSkeletonFile(
    const std::string& path, std::optional<double> unit_m,
    const std::optional<std::string>& skin = std::nullopt);

// Which joints are a humanoid's bones, as a VRM file says; empty of others.
std::vector<std::pair<std::string, std::string>> JointsOfBones(
    const GltfDocument& document, const GltfImport& import);

// The file's name without folders.
std::string BaseName(const std::string& path);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKELETON_FILE_H_
