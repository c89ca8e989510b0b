// Bodies of single-axis joints: robots.

#include <gtest/gtest.h>

#include "gelenk/retarget/floating_base.h"
#include "gelenk/retarget/humanoid.h"
#include "tests/testing/retarget_runs.h"
#include "tests/testing/robot_of_hinges.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {
namespace {

using testing::RobotOfHinges;

TEST(FloatingBaseTest, FreesTheRootAndKeepsThePlace) {
  const auto robot = RobotOfHinges();
  const auto floating = WithFloatingBase(robot);
  ASSERT_TRUE(floating.ok()) << floating.status();
  EXPECT_EQ((*floating)->joint(0).type, JointType::kFree);
  EXPECT_EQ((*floating)->position_count(), robot->position_count() + 7);
  WorldTransforms fixed;
  WorldTransforms free;
  ForwardKinematics(*robot, robot->rest_positions(), fixed);
  ForwardKinematics(**floating, (*floating)->rest_positions(), free);
  for (size_t i = 0; i < fixed.size(); ++i) {
    EXPECT_LT((fixed[i].translation - free[i].translation).norm(), 1e-12);
  }
  EXPECT_EQ(*WithFloatingBase(*floating), *floating);
}

TEST(RobotTest, WalksWithItsJointsInsideTheirLimits) {
  const auto clip = testing::BodyClipFromBvh(testing::WalkingBvh(200), "walk");
  const testing::SourceClip source = testing::MakeSource(*clip);
  const auto skeleton = *WithFloatingBase(RobotOfHinges());
  const auto map = ProposeJointMap(*skeleton);
  ASSERT_TRUE(map.ok());
  // The last joint at a place is the one that moves the bone.
  EXPECT_EQ(skeleton->joint(map->joint(BodyRole::kLeftFoot)).id, "left_foot");
  EXPECT_EQ(skeleton->joint(map->joint(BodyRole::kLeftThigh)).id, "left_thigh");
  EXPECT_EQ(skeleton->joint(map->joint(BodyRole::kRightForearm)).id,
            "right_forearm");
  const auto target = MakeBodyModel(skeleton, *map);
  ASSERT_TRUE(target.ok()) << target.status();
  for (auto way :
       {testing::RetargetWay::kOnline, testing::RetargetWay::kOffline}) {
    const auto run = RunRetarget(source, *target, way);
    ASSERT_TRUE(run.ok());
    EXPECT_LE(run->comparison.label_skate_ratio, 0.4);
    EXPECT_LE(run->quality.penetration.max_m, 5e-3);
    EXPECT_LE(run->hand_error, 0.03);
    EXPECT_EQ(run->limit_excess, 0);
    EXPECT_LE(run->comparison.largest_extra_turn_deg, 25);
  }
}

TEST(RobotTest, AFixedBaseStaysAndTheRestMoves) {
  const auto clip = testing::BodyClipFromBvh(testing::WalkingBvh(60), "walk");
  const testing::SourceClip source = testing::MakeSource(*clip);
  const auto skeleton = RobotOfHinges();
  const auto target = MakeBodyModel(skeleton, *ProposeJointMap(*skeleton));
  ASSERT_TRUE(target.ok());
  const auto run = RunRetarget(source, *target, testing::RetargetWay::kOnline);
  ASSERT_TRUE(run.ok());
  EXPECT_TRUE(run->positions.allFinite());
  EXPECT_EQ(run->limit_excess, 0);
}

}  // namespace
}  // namespace gelenk
