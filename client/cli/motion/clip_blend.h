// gelenk clip blend: two motions of one skeleton made one.
#ifndef CLIENT_CLI_MOTION_CLIP_BLEND_H_
#define CLIENT_CLI_MOTION_CLIP_BLEND_H_

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "gelenk/motion/motion_clip.h"

namespace gelenk::cli {

struct BlendOptions {
  // How much of the second motion, 0 to 1; unset means half, and all of what is
  // added.
  std::optional<double> part;
  // Only this joint of the second motion and those below it; empty means all.
  std::string below;
  // Step by step, at the same phase of the gait.
  bool gait = false;
  // From one to the other: when, and for how long.
  std::optional<double> at_s;
  double fade_s = 0.5;
  // What the second motion does beyond the one in this file is added.
  std::string beyond_path;
};

void AddBlendOptions(CLI::App& app, BlendOptions* options);

// INVALID_ARGUMENT for options that do not go together, joints that are not
// there, motions of other skeletons; errors of BlendGaits.
absl::StatusOr<MotionClip> BlendClips(const MotionClip& first,
                                      const MotionClip& second,
                                      const BlendOptions& options);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MOTION_CLIP_BLEND_H_
