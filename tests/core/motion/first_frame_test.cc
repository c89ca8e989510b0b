#include "gelenk/motion/first_frame.h"

#include <gtest/gtest.h>

#include <numbers>

#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::shared_ptr<const Skeleton> BallAndHinge() {
  Joint ball;
  ball.id = "ball";
  ball.type = JointType::kSpherical;
  Joint hinge;
  hinge.id = "hinge";
  hinge.parent_id = "ball";
  hinge.type = JointType::kRevolute;
  return *SkeletonBuilder().AddJoint(ball).AddJoint(hinge).Build();
}
constexpr int kHingeRow = 4;

// The ball turns by `step_rad` a frame, after a jump of `jump_rad`.
Eigen::MatrixXd Clip(double jump_rad, double step_rad, int frame_count) {
  Eigen::MatrixXd clip = Eigen::MatrixXd::Zero(5, frame_count);
  for (int frame = 0; frame < frame_count; ++frame) {
    const double angle =
        frame == 0 ? 0 : jump_rad + step_rad * static_cast<double>(frame);
    StoreXyzw(
        Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
        clip.col(frame).data());
  }
  return clip;
}

TEST(FirstFrameTest, FindsTheJumpOutOfTheRestPose) {
  const auto jump =
      FindFirstFrameJump(*BallAndHinge(), Clip(90 * kDegree, kDegree, 20));
  ASSERT_TRUE(jump.has_value());
  EXPECT_EQ(jump->joint, 0);
  EXPECT_NEAR(jump->angle_rad, 91 * kDegree, 1e-9);
  EXPECT_NEAR(jump->typical_rad, kDegree, 1e-9);
}

TEST(FirstFrameTest, SmoothClipsHaveNone) {
  EXPECT_FALSE(FindFirstFrameJump(*BallAndHinge(), Clip(0, kDegree, 20)));
}

TEST(FirstFrameTest, FastClipsHaveNone) {
  EXPECT_FALSE(FindFirstFrameJump(*BallAndHinge(),
                                  Clip(30 * kDegree, 25 * kDegree, 20)));
}

TEST(FirstFrameTest, ClipsTooShortToKnowHaveNone) {
  EXPECT_FALSE(
      FindFirstFrameJump(*BallAndHinge(), Clip(90 * kDegree, kDegree, 2)));
}

TEST(FirstFrameTest, AWholeTurnOfAHingeIsNoJump) {
  Eigen::MatrixXd clip = Clip(0, kDegree, 20);
  clip(kHingeRow, 0) = 360 * kDegree;
  EXPECT_FALSE(FindFirstFrameJump(*BallAndHinge(), clip));
}

// The jump as a filter or a change of rate leaves it: on several frames.
TEST(FirstFrameTest, CountsTheWayOutOfTheRestPose) {
  const auto skeleton = BallAndHinge();
  Eigen::MatrixXd clip = Clip(120 * kDegree, kDegree, 30);
  EXPECT_EQ(CountFramesBeforeMotion(*skeleton, clip), 1);
  const double way_deg[] = {0, 50, 92, 114};
  for (int frame = 0; frame < 4; ++frame) {
    StoreXyzw(ExpRotation({0, 0, way_deg[frame] * kDegree}),
              clip.col(frame).data());
  }
  EXPECT_EQ(CountFramesBeforeMotion(*skeleton, clip), 3);
  EXPECT_EQ(CountFramesBeforeMotion(*skeleton, Clip(0, kDegree, 30)), 0);
  EXPECT_EQ(CountFramesBeforeMotion(*skeleton, clip.leftCols(2)), 0);
}

TEST(FirstFrameTest, TheWayOutOfTheRestPoseIsShort) {
  Eigen::MatrixXd clip = Clip(0, 0, 60);
  for (int frame = 0; frame < 20; ++frame) {
    // Faster ever, so that every frame jumps beside the still ones after it.
    clip(kHingeRow, frame) = -(20.0 - frame) * 20 * kDegree;
  }
  EXPECT_LE(CountFramesBeforeMotion(*BallAndHinge(), clip), kMaxWayFrames);
}

}  // namespace
}  // namespace gelenk
