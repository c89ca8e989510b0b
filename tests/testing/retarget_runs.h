// One clip on one target, measured: rotations copied, online, offline.
#ifndef GELENK_TESTS_TESTING_RETARGET_RUNS_H_
#define GELENK_TESTS_TESTING_RETARGET_RUNS_H_

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/retarget/motion_quality.h"
#include "gelenk/retarget/retargeter.h"
#include "tests/testing/body_clips.h"

namespace gelenk::testing {

// A clip, its body in motion and its own contacts.
struct SourceClip {
  BodyClip clip;
  std::vector<BodyPose> poses;
  ContactLabels labels;
  MotionQuality quality;
};
SourceClip MakeSource(BodyClip clip);

enum class RetargetWay { kCopy, kOnline, kOffline };
inline constexpr std::array<RetargetWay, 3> kRetargetWays = {
    RetargetWay::kCopy, RetargetWay::kOnline, RetargetWay::kOffline};

struct RetargetRun {
  MotionQuality quality;
  MotionComparison comparison;
  // Mean distance of hands from their goals, relative to the arm.
  double hand_error = 0;
  // At worst over all frames, rad or m; of the result.
  double limit_excess = 0;
  // Part of the frames that limits changed.
  double limited_part = 0;
  Eigen::MatrixXd positions;
};

absl::StatusOr<RetargetRun> RunRetarget(
    const SourceClip& source, const std::shared_ptr<const BodyModel>& target,
    RetargetWay way);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_RETARGET_RUNS_H_
