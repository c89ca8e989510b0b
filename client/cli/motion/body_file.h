// Files as bodies: a skeleton, which of its joints play which roles, and the
// motion that came with it.
#ifndef CLIENT_CLI_MOTION_BODY_FILE_H_
#define CLIENT_CLI_MOTION_BODY_FILE_H_

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "client/cli/motion/motion_file.h"
#include "client/cli/skeleton_file.h"
#include "gelenk/retarget/moving_body.h"

namespace gelenk::cli {

struct BodyFile : MovingBody {
  std::string name;
  // What was told of its joint map: by the file itself (VRM), or by the user.
  std::vector<JointMapOverride> roles;
  // What a BVH file's own form is written back into.
  std::optional<BvhClip> clip;
  // A column a frame, with what was left out before the motion; null without
  // motion.
  std::shared_ptr<const Eigen::MatrixXd> frames;
};

// A file as ReadSkeletonFile takes it, or the name of a bundled skeleton
// ("humanoid"). A robot gets a base that floats. `overrides` go before what a
// VRM file says of its bones. A model stands as it does at rest: its animations
// may be anything. Errors name the file; a body without pelvis or limbs is
// INVALID_ARGUMENT.
absl::StatusOr<BodyFile> ReadBodyFile(
    const std::string& path, std::optional<double> unit_m,
    absl::Span<const JointMapOverride> overrides = {});

// The same with the motion that is in the file, also the animation of a glTF
// file. One without motion is no error here.
absl::StatusOr<BodyFile> ReadMovingBodyFile(
    const std::string& path, const MotionFileOptions& options,
    absl::Span<const JointMapOverride> overrides = {});

// Both maps as a file has them: {"source": [{"role", "joint"}], "target": ..}.
struct MapFile {
  std::vector<JointMapOverride> source;
  std::vector<JointMapOverride> target;
};
// INVALID_ARGUMENT naming file and entry.
absl::StatusOr<MapFile> ReadMapFile(const std::string& path);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MOTION_BODY_FILE_H_
