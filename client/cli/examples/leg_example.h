// The leg of the animation books: hip, knee and foot animated by keys from the
// top down, which slides over the ground and sinks into it; and the same motion
// with its contacts kept.
#ifndef CLIENT_CLI_EXAMPLES_LEG_EXAMPLE_H_
#define CLIENT_CLI_EXAMPLES_LEG_EXAMPLE_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/body_pose.h"
#include "gelenk/retarget/motion_quality.h"

namespace gelenk::cli {

// One way to the motion. The ground is flat, at height 0.
struct LegMotion {
  // Canonical, a frame each.
  std::vector<BodyPose> poses;
  MotionQuality quality;
};

struct LegExample {
  // A hip and two legs, the right one half a cycle behind the left one.
  std::shared_ptr<const BodyModel> model;
  double frame_time_s = 0;
  // Where the feet of the keyed motion stand, which counts for both.
  ContactLabels labels;
  LegMotion keyed;
  LegMotion planted;
};

absl::StatusOr<LegExample> MakeLegExample();

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_EXAMPLES_LEG_EXAMPLE_H_
