// Rotation goals of which only some world axes count.
#include <gtest/gtest.h>

#include <cmath>

#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/core/ik/goals/solve_goals.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::GoalOf;
using ::gelenk::testing::PandaArm;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomRotation;
using ::gelenk::testing::Solved;
using ::gelenk::testing::SolveGoals;
using ::gelenk::testing::StartNear;
using ::gelenk::testing::Uniform;

constexpr double kTolerance = 1e-3;
constexpr AxisMask kUpright = {true, false, true};  // Yaw is free.
constexpr AxisMask kYaw = {false, true, false};

std::shared_ptr<const Skeleton> Ball() {
  Joint ball;
  ball.id = "ball";
  ball.type = JointType::kSpherical;
  return SkeletonBuilder().AddJoint(ball).Build().value();
}

Eigen::Quaterniond SolveBall(const RotationGoal& goal,
                             const Eigen::Quaterniond& start,
                             SolveReport* report) {
  const auto ball = Ball();
  Eigen::VectorXd positions(4);
  StoreXyzw(start, positions.data());
  const Solved solved = SolveGoals(ball, {GoalOf(goal)}, positions);
  *report = solved.report;
  return QuaternionXyzw(solved.positions.data());
}

// The part of `rotation` about Y, rad.
double YawOf(const Eigen::Quaterniond& rotation) {
  return DecomposeSwingTwist(rotation, Eigen::Vector3d::UnitY()).twist_rad;
}

double Tilt(const Eigen::Quaterniond& rotation) {
  return DecomposeSwingTwist(rotation, Eigen::Vector3d::UnitY()).swing_rad;
}

// From anywhere the axis comes upright; what yaw there was makes no difference,
// however large.
TEST(RotationAxesTest, UprightWithAnyYaw) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const RotationGoal goal = {"ball", ExpRotation({0, 0.1 * i, 0}), kUpright};
    SolveReport report;
    const Eigen::Quaterniond got =
        SolveBall(goal, RandomRotation(random), &report);
    EXPECT_EQ(report.outcome, SolveOutcome::kConverged);
    EXPECT_LE(Tilt(got), kTolerance);
    EXPECT_LE(report.iteration_count, 12);
  }
}

TEST(RotationAxesTest, UpsideDownTurnsRound) {
  for (const Eigen::Vector3d& about :
       {Eigen::Vector3d(M_PI, 0, 0), Eigen::Vector3d(0, 0, M_PI)}) {
    SolveReport report;
    const Eigen::Quaterniond got =
        SolveBall({"ball", Eigen::Quaterniond::Identity(), kUpright},
                  ExpRotation(about), &report);
    EXPECT_EQ(report.outcome, SolveOutcome::kConverged);
    EXPECT_LE(Tilt(got), kTolerance);
  }
}

// What does not count is left about as it is: each step turns no more than it
// needs.
TEST(RotationAxesTest, OnlyTheAskedPartMoves) {
  const Eigen::Quaterniond start =
      ExpRotation({0, 1.2, 0}) * ExpRotation({0.4, 0, 0});
  SolveReport report;
  const Eigen::Quaterniond upright = SolveBall(
      {"ball", Eigen::Quaterniond::Identity(), kUpright}, start, &report);
  EXPECT_NEAR(YawOf(upright), 1.2, 1e-3);
  EXPECT_NEAR(AngleBetween(start, upright), 0.4, 1e-3);
  const Eigen::Quaterniond turned =
      SolveBall({"ball", Eigen::Quaterniond::Identity(), kYaw}, start, &report);
  EXPECT_EQ(report.outcome, SolveOutcome::kConverged);
  EXPECT_LE(std::abs(YawOf(turned)), kTolerance);
  EXPECT_NEAR(Tilt(turned), 0.4, 0.1);
}

TEST(RotationAxesTest, YawFromAnywhere) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Quaterniond start = RandomRotation(random);
    if (Tilt(start) > 3) continue;  // Its yaw is next to undefined.
    const RotationGoal goal = {"ball", ExpRotation({0, 0.05 * i, 0}), kYaw};
    SolveReport report;
    const Eigen::Quaterniond got = SolveBall(goal, start, &report);
    EXPECT_EQ(report.outcome, SolveOutcome::kConverged) << i;
    EXPECT_LE(std::abs(YawOf(goal.world_rotation * got.conjugate())),
              1.01 * kTolerance);
  }
}

TEST(RotationAxesTest, HalfATwistTurnsRound) {
  SolveReport report;
  const Eigen::Quaterniond got =
      SolveBall({"ball", Eigen::Quaterniond::Identity(), kYaw},
                ExpRotation({0, M_PI, 0}), &report);
  EXPECT_EQ(report.outcome, SolveOutcome::kConverged);
  EXPECT_LE(std::abs(YawOf(got)), kTolerance);
}

TEST(RotationAxesTest, NoAxesAskForNothing) {
  SolveReport report;
  const Eigen::Quaterniond start = ExpRotation({1, 2, 0.5});
  const Eigen::Quaterniond got =
      SolveBall({"ball", Eigen::Quaterniond::Identity(), {false, false, false}},
                start, &report);
  EXPECT_EQ(report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(report.iteration_count, 0);
  EXPECT_EQ(AngleBetween(got, start), 0);
}

// A cup that is carried: its place counts, and that it stays upright.
TEST(RotationAxesTest, ArmsCarryACup) {
  Random random(3);
  const auto arm = PandaArm();
  int converged = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *arm);
    PoseGoal cup;
    cup.end_effector_id = "tip";
    cup.world_pose = EffectorPose(*arm, truth, "tip");
    cup.rotation_axes = {true, true, false};
    const Solved solved =
        SolveGoals(arm, {GoalOf(cup)}, StartNear(random, *arm, truth, 0.2));
    if (solved.report.outcome != SolveOutcome::kConverged) continue;
    ++converged;
    const RigidTransform got = EffectorPose(*arm, solved.positions, "tip");
    const Eigen::Quaterniond left =
        cup.world_pose.rotation * got.rotation.conjugate();
    EXPECT_LE(DecomposeSwingTwist(left, Eigen::Vector3d::UnitZ()).swing_rad,
              1.01 * kTolerance);
    EXPECT_LE((got.translation - cup.world_pose.translation).norm(), 1.01e-4);
  }
  EXPECT_GE(converged, 198);
}

}  // namespace
}  // namespace gelenk
