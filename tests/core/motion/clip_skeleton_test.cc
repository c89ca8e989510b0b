#include "gelenk/motion/clip_skeleton.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gelenk/motion/clip_frames.h"
#include "gelenk/retarget/humanoid.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ViolationLines;

TEST(ClipSkeletonTest, TheSameJointsInAnotherObject) {
  const auto one = MakeHumanoid();
  const auto other = MakeHumanoid();
  testing::Random random(5);
  Eigen::MatrixXd frames(one->position_count(), 3);
  for (int i = 0; i < 3; ++i) frames.col(i) = testing::RandomPose(random, *one);
  const MotionClip clip =
      ClipFromFrames(one, frames, {.name = "a", .frame_time_s = 0.1}).value();
  const auto moved = OnSkeleton(clip, other);
  ASSERT_TRUE(moved.ok()) << moved.status();
  EXPECT_EQ(moved->skeleton(), other);
  EXPECT_EQ(moved->name(), "a");
  EXPECT_EQ(FramesFromClip(*moved).value(), FramesFromClip(clip).value());
}

TEST(ClipSkeletonTest, OtherLengthsAreAnotherSkeleton) {
  const auto tall = MakeHumanoid(2);
  const auto clip = MotionClip::Create(tall, {}).value();
  const auto lines = ViolationLines(OnSkeleton(clip, MakeHumanoid()).status());
  EXPECT_THAT(lines, Not(IsEmpty()));
  EXPECT_THAT(lines[0], HasSubstr("m and 0 rad from where it should be"));
}

TEST(ClipSkeletonTest, OtherJointsAreAnotherSkeleton) {
  EXPECT_THAT(
      ViolationLines(CheckSameJoints(*testing::PandaArm(), *MakeHumanoid())),
      ElementsAre(HasSubstr("joints: want 22 with")));
}

}  // namespace
}  // namespace gelenk
