#include "gelenk/ik/goal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

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

TEST(GoalKindTest, NamesTheEffectorOfEveryKind) {
  AimGoal aim;
  aim.end_effector_id = "eye";
  EXPECT_EQ(EffectorId(GoalKind(aim)), "eye");
  EXPECT_EQ(EffectorId(GoalKind(PoleGoal{"hip", "knee", "ankle", {0, 0, 1}})),
            "ankle");
  EXPECT_EQ(EffectorId(GoalKind(RelativeGoal{"left", "right", {}, 1})),
            "right");
  EXPECT_EQ(EffectorId(GoalKind(CenterOfMassGoal())), "");
  EXPECT_EQ(EffectorId(GoalKind(PostureGoal())), "");
  EXPECT_EQ(EffectorId(GoalKind(HalfSpaceGoal{"sole", {0, 1, 0}, 0})), "sole");
  EXPECT_EQ(EffectorId(GoalKind(PlantGoal{"sole", 1})), "sole");
}

TEST(GoalKindTest, TargetsFitTheSortOfTheirKind) {
  const auto sort_of = [](const GoalKind& kind) {
    return TargetOf(kind).index();
  };
  const GoalKind kinds[] = {PositionGoal(), RotationGoal(),     PoseGoal(),
                            AimGoal(),      PoleGoal(),         RelativeGoal(),
                            PostureGoal(),  CenterOfMassGoal(), HalfSpaceGoal(),
                            PlantGoal()};
  for (const GoalKind& kind : kinds) {
    const bool takes_one = !std::holds_alternative<PlantGoal>(kind);
    for (const GoalKind& other : kinds) {
      EXPECT_EQ(Fits(kind, TargetOf(other)),
                takes_one && sort_of(kind) == sort_of(other))
          << GoalKindName(kind) << " and " << GoalKindName(other);
    }
  }
}

template <class Kind, class Target>
Target Retargeted(Kind kind, const Target& target) {
  GoalKind goal = kind;
  Retarget(goal, target);
  return std::get<Target>(TargetOf(goal));
}

TEST(GoalKindTest, RetargetReplacesThePointOfEveryKindWithOne) {
  const Eigen::Vector3d point(1, 2, 3);
  EXPECT_EQ(Retargeted(PositionGoal(), point), point);
  EXPECT_EQ(Retargeted(AimGoal(), point), point);
  EXPECT_EQ(Retargeted(PoleGoal(), point), point);
  EXPECT_EQ(Retargeted(CenterOfMassGoal(), point), point);
}

TEST(GoalKindTest, RetargetReplacesPlanesPosturesAndRelativePoses) {
  const Plane plane = Retargeted(HalfSpaceGoal(), Plane{{1, 0, 0}, -2});
  EXPECT_EQ(plane.world_normal, Eigen::Vector3d::UnitX());
  EXPECT_EQ(plane.offset_m, -2);
  const Eigen::VectorXd posture = Eigen::Vector2d(3, 4);
  EXPECT_EQ(Retargeted(PostureGoal(), posture), posture);
  const RigidTransform pose = {Eigen::Quaterniond(0, 1, 0, 0), {5, 6, 7}};
  EXPECT_EQ(Retargeted(RelativeGoal(), pose).translation, pose.translation);
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

TEST(CheckTargetTest, PlanesNeedADirection) {
  GoalTarget target = Plane{{0, 0, 0}, NAN};
  EXPECT_THAT(ViolationLines(CheckAndNormalize(target)),
              ElementsAre("plane.world_normal: want a direction, got (0, 0, 0)",
                          "plane.offset_m: want a finite number, got nan"));
  target = Plane{{0, 3, 4}, 2};
  EXPECT_TRUE(CheckAndNormalize(target).ok());
  EXPECT_EQ(std::get<Plane>(target).world_normal, Eigen::Vector3d(0, 0.6, 0.8));
  EXPECT_EQ(std::get<Plane>(target).offset_m, 2);
}

// Of a goal with that kind and nothing else wrong.
std::vector<std::string> LinesOf(const GoalKind& kind) {
  Goal goal = {"goal", 1, kind};
  return ViolationLines(CheckAndNormalize(goal));
}

TEST(CheckGoalTest, AimWantsAnAxisAndAPoint) {
  AimGoal aim;
  aim.axis = {0, 1e-10, 0};
  aim.world_point.x() = NAN;
  EXPECT_THAT(LinesOf(aim),
              ElementsAre("aim.axis: want a direction, got (0, 1e-10, 0)",
                          "aim.world_point: want finite numbers, got (nan, 0, "
                          "0)"));
  aim.axis = {INFINITY, 0, 0};
  aim.world_point.x() = 0;
  EXPECT_THAT(LinesOf(aim),
              ElementsAre("aim.axis: want a direction, got (inf, 0, 0)"));
}

TEST(CheckGoalTest, NormalisesAxesAndNormals) {
  AimGoal aim;
  aim.axis = {0, 0, -2e-9};
  Goal goal = {"goal", 1, aim};
  EXPECT_TRUE(CheckAndNormalize(goal).ok());
  EXPECT_TRUE(
      std::get<AimGoal>(goal.kind).axis.isApprox(-Eigen::Vector3d::UnitZ()));
  HalfSpaceGoal ground;
  ground.world_normal = {0, 1e200, 0};
  goal.kind = ground;
  EXPECT_TRUE(CheckAndNormalize(goal).ok());
  EXPECT_TRUE(std::get<HalfSpaceGoal>(goal.kind).world_normal.isApprox(
      Eigen::Vector3d::UnitY()));
}

TEST(CheckGoalTest, EveryKindNamesItsOwnFields) {
  EXPECT_THAT(LinesOf(PoleGoal{"", "", "", {0, NAN, 0}}),
              ElementsAre("pole.world_point: want finite numbers, got (0, nan, "
                          "0)"));
  RelativeGoal relative;
  relative.reference_from_end_effector = {kHalfLong, {0, 0, INFINITY}};
  relative.rotation_scale_m_per_rad = -1;
  EXPECT_THAT(
      LinesOf(relative),
      ElementsAre("relative.reference_from_end_effector.translation: want "
                  "finite numbers, got (0, 0, inf)",
                  "relative.reference_from_end_effector.rotation: want a unit "
                  "quaternion, got (0.25, 0.25, 0.25, 0.25)",
                  "relative.rotation_scale_m_per_rad: want a finite number >= "
                  "0, got -1"));
  CenterOfMassGoal center;
  center.world_position.y() = INFINITY;
  EXPECT_THAT(LinesOf(center),
              ElementsAre("center_of_mass.world_position: want finite numbers, "
                          "got (0, inf, 0)"));
  EXPECT_THAT(LinesOf(PostureGoal{{}, {1, 0, -2, NAN}}),
              ElementsAre("posture.joint_weights[2]: want a finite number >= "
                          "0, got -2",
                          "posture.joint_weights[3]: want a finite number >= "
                          "0, got nan"));
  EXPECT_THAT(
      LinesOf(HalfSpaceGoal{"sole", {0, 0, 0}, INFINITY}),
      ElementsAre("half_space.world_normal: want a direction, got (0, "
                  "0, 0)",
                  "half_space.offset_m: want a finite number, got inf"));
  EXPECT_THAT(LinesOf(PlantGoal{"sole", NAN}),
              ElementsAre("plant.rotation_scale_m_per_rad: want a finite "
                          "number >= 0, got nan"));
}

TEST(CheckGoalTest, PrioritiesFromBothSides) {
  Goal goal = PoseGoalFor("head", {});
  for (int priority : {0, kMaxPriorities - 1}) {
    goal.priority = priority;
    EXPECT_TRUE(CheckAndNormalize(goal).ok());
  }
  goal.priority = -1;
  EXPECT_THAT(ViolationLines(CheckAndNormalize(goal)),
              ElementsAre("priority: want 0 to 7, got -1"));
  goal.priority = kMaxPriorities;
  EXPECT_THAT(ViolationLines(CheckAndNormalize(goal)),
              ElementsAre("priority: want 0 to 7, got 8"));
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
