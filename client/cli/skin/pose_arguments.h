// Poses for a skin, as the command line gives them.
#ifndef CLIENT_CLI_SKIN_POSE_ARGUMENTS_H_
#define CLIENT_CLI_SKIN_POSE_ARGUMENTS_H_

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cli/motion/motion_file.h"
#include "gelenk/v1/skin_service.pb.h"

namespace gelenk::cli {

struct PoseArguments {
  std::string pose;
  std::string motion_path;
  MotionFileOptions motion;
  // The motion is of another body.
  bool retargets = false;
  int first_frame = 0;
  std::optional<int> frame_count;
};

// --pose, or --bvh with --retarget, --bvh-unit, --animation, --first and
// --frames.
void AddPoseOptions(CLI::App& app, PoseArguments* arguments);

struct PoseList {
  std::vector<v1::SkinPose> poses;
  // Between two of them.
  absl::Duration frame_time = absl::Seconds(1) / 30;
};

// Of `skeleton`. Without any, none. INVALID_ARGUMENT naming the option or the
// file; a motion on other joints says so once.
absl::StatusOr<PoseList> PosesOf(const PoseArguments& arguments,
                                 const v1::Skeleton& skeleton);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_POSE_ARGUMENTS_H_
