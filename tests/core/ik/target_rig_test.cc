#include "gelenk/ik/target_rig.h"

#include <gtest/gtest.h>

#include <variant>
#include <vector>

#include "tests/testing/example_skeletons.h"

namespace gelenk {
namespace {

// A point, a rotation, a pose, and a plane that has no place in a rig.
std::vector<Goal> Goals() {
  RotationGoal aim;
  aim.end_effector_id = "j1";
  PoseGoal grip;
  grip.end_effector_id = "tip";
  HalfSpaceGoal above;
  above.end_effector_id = "tip";
  return {{"reach", 1, PositionGoal{"tip", {0.9, 0.5, 0}, {}}},
          {"aim", 1, aim},
          {"grip", 1, grip},
          {"above", 1, above}};
}

IkProblem Problem() {
  return *IkProblem::Create(
      testing::PlanarChain(Eigen::Vector3d::Zero(), {0.5, 0.5}), Goals());
}

TEST(TargetRigTest, TargetsGoThroughAPoseUnchanged) {
  const TargetRig rig(4);
  const Eigen::Quaterniond turned(
      Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()));
  const std::vector<GoalTarget> targets = {
      Eigen::Vector3d(1, 2, 3), turned,
      RigidTransform{turned, Eigen::Vector3d(4, 5, 6)}};
  Eigen::VectorXd positions = rig.PositionsOf(Goals());
  for (int i = 0; i < 3; ++i) rig.Put(i, targets[i], positions);
  EXPECT_TRUE(CheckPositions(*rig.skeleton(), positions).ok());
  IkProblem problem = Problem();
  rig.Aim(positions, problem);
  EXPECT_EQ(std::get<PositionGoal>(problem.goals()[0].kind).world_position,
            Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(
      std::get<RotationGoal>(problem.goals()[1].kind).world_rotation.coeffs(),
      turned.coeffs());
  const RigidTransform& pose =
      std::get<PoseGoal>(problem.goals()[2].kind).world_pose;
  EXPECT_EQ(pose.rotation.coeffs(), turned.coeffs());
  EXPECT_EQ(pose.translation, Eigen::Vector3d(4, 5, 6));
}

TEST(TargetRigTest, WhatHasNoPlaceStaysAlone) {
  EXPECT_FALSE(TargetRig::Takes(Plane()));
  EXPECT_FALSE(TargetRig::Takes(Eigen::VectorXd(Eigen::Vector2d::Zero())));
  EXPECT_TRUE(TargetRig::Takes(Eigen::Vector3d(0, 0, 0)));
  const TargetRig rig(4);
  const Eigen::VectorXd positions = rig.PositionsOf(Goals());
  Eigen::VectorXd after = positions;
  rig.Put(3, Plane(), after);
  EXPECT_EQ(after, positions);
}

}  // namespace
}  // namespace gelenk
