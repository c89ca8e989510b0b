#include "gelenk/ik/goal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/testing/ik_targets.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::PoseGoalFor;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::RotationGoalFor;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

const Eigen::Quaterniond kHalfLong(0.25, 0.25, 0.25, 0.25);  // Norm 1/2.

TEST(GoalKindTest, NamesKindAndEffector) {
  const Goal position = PositionGoalFor("palm", {1, 2, 3});
  const Goal rotation = RotationGoalFor("sole", Eigen::Quaterniond::Identity());
  const Goal pose = PoseGoalFor("head", {});
  EXPECT_EQ(GoalKindName(position.kind), "position");
  EXPECT_EQ(GoalKindName(rotation.kind), "rotation");
  EXPECT_EQ(GoalKindName(pose.kind), "pose");
  EXPECT_EQ(EffectorId(position.kind), "palm");
  EXPECT_EQ(EffectorId(rotation.kind), "sole");
  EXPECT_EQ(EffectorId(pose.kind), "head");
}

TEST(GoalKindTest, TargetsFitTheirOwnKindOnly) {
  const GoalKind kinds[] = {PositionGoal(), RotationGoal(), PoseGoal()};
  for (const GoalKind& kind : kinds) {
    for (const GoalKind& other : kinds) {
      EXPECT_EQ(Fits(kind, TargetOf(other)), kind.index() == other.index());
    }
  }
}

TEST(GoalKindTest, RetargetReplacesTheTarget) {
  Goal goal = PoseGoalFor("head", {});
  std::get<PoseGoal>(goal.kind).rotation_scale_m_per_rad = 0.3;
  RigidTransform target;
  target.translation = {1, 2, 3};
  Retarget(goal.kind, target);
  const PoseGoal& pose = std::get<PoseGoal>(goal.kind);
  EXPECT_EQ(pose.world_pose.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(pose.rotation_scale_m_per_rad, 0.3);
  EXPECT_EQ(pose.end_effector_id, "head");
}

TEST(CheckTargetTest, WantsFinitePoints) {
  GoalTarget target = Eigen::Vector3d(1, NAN, 3);
  EXPECT_THAT(ViolationLines(CheckAndNormalize(target)),
              ElementsAre("world_position: want finite numbers, got (1, nan, "
                          "3)"));
}

TEST(CheckTargetTest, WantsUnitQuaternions) {
  GoalTarget target = kHalfLong;
  EXPECT_THAT(ViolationLines(CheckAndNormalize(target)),
              ElementsAre("world_rotation: want a unit quaternion, got (0.25, "
                          "0.25, 0.25, 0.25)"));
}

TEST(CheckTargetTest, ListsBothPartsOfAPose) {
  RigidTransform pose;
  pose.translation.z() = -INFINITY;
  pose.rotation = kHalfLong;
  GoalTarget target = pose;
  EXPECT_THAT(ViolationLines(CheckAndNormalize(target)),
              ElementsAre("world_pose.translation: want finite numbers, got "
                          "(0, 0, -inf)",
                          "world_pose.rotation: want a unit quaternion, got "
                          "(0.25, 0.25, 0.25, 0.25)"));
}

TEST(CheckTargetTest, NormalisesNearUnitQuaternions) {
  GoalTarget target = Eigen::Quaterniond(1 + 5e-4, 0, 0, 0);
  EXPECT_TRUE(CheckAndNormalize(target).ok());
  EXPECT_EQ(std::get<Eigen::Quaterniond>(target).w(), 1);
}

TEST(CheckGoalTest, ListsEverythingAtOnce) {
  Goal goal = PoseGoalFor("head", {});
  goal.id = "";
  goal.weight = -1;
  std::get<PoseGoal>(goal.kind).world_pose.translation.x() = NAN;
  std::get<PoseGoal>(goal.kind).rotation_scale_m_per_rad = INFINITY;
  EXPECT_THAT(
      ViolationLines(CheckAndNormalize(goal)),
      ElementsAre("goal_id: want 1 to 63 bytes, got 0",
                  "weight: want a finite number >= 0, got -1",
                  "pose.world_pose.translation: want finite numbers, got (nan, "
                  "0, 0)",
                  "pose.rotation_scale_m_per_rad: want a finite number >= 0, "
                  "got inf"));
}

TEST(CheckGoalTest, WeightAndScaleFromBothSides) {
  Goal goal = PoseGoalFor("head", {});
  goal.weight = 0;
  std::get<PoseGoal>(goal.kind).rotation_scale_m_per_rad = 0;
  EXPECT_THAT(ViolationLines(CheckAndNormalize(goal)), IsEmpty());
  goal.weight = NAN;
  EXPECT_THAT(ViolationLines(CheckAndNormalize(goal)),
              ElementsAre("weight: want a finite number >= 0, got nan"));
}

TEST(CheckGoalTest, NormalisesTheTarget) {
  Goal goal = RotationGoalFor("sole", Eigen::Quaterniond(1 - 5e-4, 0, 0, 0));
  EXPECT_TRUE(CheckAndNormalize(goal).ok());
  EXPECT_EQ(std::get<RotationGoal>(goal.kind).world_rotation.w(), 1);
}

}  // namespace
}  // namespace gelenk
