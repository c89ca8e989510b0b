#include "gelenk/ik/goals/aim_goal.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/core/ik/goals/solve_goals.h"
#include "tests/testing/example_bodies.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::GoalOf;
using ::gelenk::testing::Leg;
using ::gelenk::testing::PandaArm;
using ::gelenk::testing::PersonWithFingers;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomDirection;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::Solved;
using ::gelenk::testing::SolveGoals;
using ::gelenk::testing::StartNear;
using ::gelenk::testing::Uniform;

constexpr double kTolerance = 1e-3;  // The solver's, rad.
constexpr double kRounding = 1e-7;

// Between the axis and the way to the point.
double MissedAngle(const Skeleton& skeleton, const Eigen::VectorXd& positions,
                   const AimGoal& aim) {
  const RigidTransform pose =
      EffectorPose(skeleton, positions, aim.end_effector_id);
  const Eigen::Vector3d axis = pose.rotation * aim.axis;
  const Eigen::Vector3d way = aim.world_point - pose.translation;
  return std::atan2(axis.cross(way).norm(), axis.dot(way));
}

TEST(AimGoalTest, AHeadLooksAtAPoint) {
  const auto person = PersonWithFingers();
  const AimGoal aim = {"head", {0, 0, 1}, {0.7, 1.4, 2}};
  const Solved solved =
      SolveGoals(person, {GoalOf(aim)}, person->rest_positions());
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  const double missed = MissedAngle(*person, solved.positions, aim);
  EXPECT_LE(missed, kTolerance);
  EXPECT_NEAR(solved.report.rotation_errors_rad[0], missed, kRounding);
  EXPECT_EQ(solved.report.position_errors_m[0], 0);
}

TEST(AimGoalTest, ArmsAimWhereTheyCould) {
  Random random(1);
  const auto arm = PandaArm();
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *arm);
    const Eigen::Vector3d axis = RandomDirection(random);
    const AimGoal aim = {
        "tip", axis,
        EffectorPose(*arm, truth, "tip") * (Uniform(random, 0.3, 3) * axis)};
    const Solved solved =
        SolveGoals(arm, {GoalOf(aim)}, StartNear(random, *arm, truth, 0.3));
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged) << i;
    EXPECT_LE(MissedAngle(*arm, solved.positions, aim), kTolerance + kRounding);
  }
}

// Whatever hinge there is, half a turn is begun.
TEST(AimGoalTest, ExactlyBackwardsTurnsRound) {
  for (const Eigen::Vector3d& base :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0)}) {
    const auto chain = PlanarChain(base, {1, 1, 1});
    const AimGoal aim = {"tip", {1, 0, 0}, {-5, 0, 0}};
    const Solved solved =
        SolveGoals(chain, {GoalOf(aim)}, Eigen::Vector3d::Zero());
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
    EXPECT_LE(MissedAngle(*chain, solved.positions, aim), kTolerance);
  }
  const auto leg = Leg(false);
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0),
        Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, -1)}) {
    const AimGoal aim = {"hip", axis, -3 * axis};
    const Solved solved =
        SolveGoals(leg, {GoalOf(aim)}, NeutralPositions(*leg));
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
    EXPECT_LE(MissedAngle(*leg, solved.positions, aim), kTolerance);
  }
}

// There is no direction to it: any is right.
TEST(AimGoalTest, ThePointInTheOriginAsksForNothing) {
  const auto leg = Leg(false);
  const Eigen::VectorXd start = NeutralPositions(*leg);
  for (double off_m : {0.0, 1e-300, 1e-12, 1e-6}) {
    const AimGoal aim = {"hip", {0, 0, 1}, {off_m, 0, 0}};
    const Solved solved = SolveGoals(leg, {GoalOf(aim)}, start);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged) << off_m;
    EXPECT_TRUE(solved.positions.allFinite());
    EXPECT_LE(solved.report.rotation_errors_rad[0], kTolerance);
  }
}

// Passing through the origin of what looks at it.
TEST(AimGoalTest, APointThatFliesThroughStaysFinite) {
  const auto person = PersonWithFingers();
  Eigen::VectorXd q = person->rest_positions();
  const Eigen::Vector3d head = EffectorPose(*person, q, "head").translation;
  for (int frame = -20; frame <= 20; ++frame) {
    const AimGoal aim = {
        "head", {0, 0, 1}, head + Eigen::Vector3d(0.01 * frame, 0, 0)};
    q = SolveGoals(person, {GoalOf(aim)}, q).positions;
    ASSERT_TRUE(q.allFinite()) << frame;
    EXPECT_LE(LimitExcess(*person, q, nullptr), 1e-9);
  }
}

TEST(AimGoalTest, OutOfReachComesAsNearAsLimitsLet) {
  SkeletonBuilder builder;
  Joint neck;
  neck.id = "neck";
  neck.type = JointType::kRevolute;
  neck.axis = Eigen::Vector3d::UnitY();
  neck.limits.lower = {-0.5};
  neck.limits.upper = {0.5};
  const auto head = builder.AddJoint(neck).Build().value();
  const AimGoal aim = {"neck", {0, 0, 1}, {2, 0, 0}};
  const Solved solved =
      SolveGoals(head, {GoalOf(aim)}, Eigen::VectorXd::Zero(1));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kStalledAtLimits);
  EXPECT_EQ(solved.report.limited_joints, std::vector<int>{0});
  EXPECT_NEAR(solved.report.rotation_errors_rad[0], M_PI / 2 - 0.5, 1e-6);
  EXPECT_EQ(solved.positions[0], 0.5);
}

}  // namespace
}  // namespace gelenk
