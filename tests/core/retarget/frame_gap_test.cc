#include "gelenk/retarget/frame_gap.h"

#include <gtest/gtest.h>

#include <limits>

#include "gelenk/math/rotation.h"
#include "gelenk/retarget/humanoid.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

constexpr double kFrameTime = 0.01;

// The largest part of the way between two poses.
double DistanceBetween(const Skeleton& skeleton, const Eigen::VectorXd& a,
                       const Eigen::VectorXd& b) {
  Eigen::VectorXd way(skeleton.velocity_count());
  Difference(skeleton, a, b, way);
  return way.cwiseAbs().maxCoeff();
}

// Two frames of a body whose left hand turns and whose root goes at 1 m/s.
struct Moving {
  std::shared_ptr<const Skeleton> skeleton = MakeHumanoid();
  Eigen::VectorXd first = skeleton->rest_positions();
  Eigen::VectorXd velocity = Eigen::VectorXd::Zero(skeleton->velocity_count());

  Moving() {
    velocity[2] = 1;
    velocity.tail<3>() << 0.5, 0, 0;
  }
  Eigen::VectorXd At(double time_s) const {
    Eigen::VectorXd positions = first;
    Integrate(*skeleton, first, time_s * velocity, positions);
    return positions;
  }
  FrameGap Gap(const GapOptions& options) const {
    FrameGap gap(skeleton, skeleton->rest_positions(), options);
    for (int f = 0; f < 5; ++f) gap.Take(At(f * kFrameTime), kFrameTime);
    return gap;
  }
};

TEST(FrameGapTest, HoldsThenEasesToRestWhereItStands) {
  const Moving moving;
  GapOptions options;
  FrameGap gap = moving.Gap(options);
  const Eigen::VectorXd last = moving.At(4 * kFrameTime);
  Eigen::VectorXd before = last;
  for (int f = 1; f <= 200; ++f) {
    const Eigen::VectorXd& filled = gap.Fill(kFrameTime);
    if (gap.gap_s() < options.hold_s) {
      ASSERT_LT(DistanceBetween(*moving.skeleton, filled, last), 1e-12);
    }
    ASSERT_LT(DistanceBetween(*moving.skeleton, before, filled), 0.01);
    before = filled;
  }
  Eigen::VectorXd rest = moving.skeleton->rest_positions();
  rest.head<7>() = last.head<7>();
  EXPECT_LT(DistanceBetween(*moving.skeleton, before, rest), 1e-12);
}

TEST(FrameGapTest, ExtrapolatesAtFirstAsItWentAndThenNoFarther) {
  const Moving moving;
  GapOptions options;
  options.policy = GapPolicy::kExtrapolate;
  options.hold_s = 10;
  FrameGap gap = moving.Gap(options);
  // The first frame is near the true one, ...
  EXPECT_LT(DistanceBetween(*moving.skeleton, gap.Fill(kFrameTime),
                            moving.At(5 * kFrameTime)),
            0.1 * kFrameTime);
  // ... after long it is what was covered in extrapolation_s.
  for (int f = 0; f < 300; ++f) gap.Fill(kFrameTime);
  EXPECT_LT(
      DistanceBetween(*moving.skeleton, gap.Fill(kFrameTime),
                      moving.At(4 * kFrameTime + options.extrapolation_s)),
      1e-6);
}

TEST(FrameGapTest, AFrameEndsTheGap) {
  const Moving moving;
  GapOptions options;
  options.policy = GapPolicy::kExtrapolate;
  FrameGap gap = moving.Gap(options);
  gap.Fill(0.3);
  EXPECT_EQ(gap.gap_s(), 0.3);
  gap.Take(moving.At(1), 0.3);
  EXPECT_EQ(gap.gap_s(), 0);
  // What the speed was over the gap, nobody knows.
  EXPECT_LT(
      DistanceBetween(*moving.skeleton, gap.Fill(kFrameTime), moving.At(1)),
      1e-12);
}

TEST(FrameGapTest, OptionsAreChecked) {
  GapOptions options;
  EXPECT_TRUE(CheckGapOptions(options).ok());
  options.hold_s = -1;
  options.ease_s = std::numeric_limits<double>::infinity();
  for (const char* field : {"hold_s", "ease_s"}) {
    EXPECT_THAT(CheckGapOptions(options),
                testing::Fails(absl::StatusCode::kInvalidArgument, field));
  }
}

}  // namespace
}  // namespace gelenk
