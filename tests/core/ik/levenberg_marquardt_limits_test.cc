// Swing cones, twist ranges and limits of mimic joints inside the solver; the
// boxes of plain joints are in levenberg_marquardt_solver_test.cc.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/ik_targets.h"

namespace gelenk {
namespace {

using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::RotationGoalFor;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A clamped rotation is on its bound to this, rad.
constexpr double kOnBound = 1e-9;

std::shared_ptr<const Skeleton> BallJoint(const JointLimits& limits) {
  Joint ball;
  ball.id = "ball";
  ball.type = JointType::kSpherical;
  ball.axis = Eigen::Vector3d::UnitX();
  ball.limits = limits;
  return SkeletonBuilder().AddJoint(ball).Build().value();
}

struct Solved {
  Eigen::VectorXd positions;
  SolveReport report;

  Eigen::Quaterniond rotation() const {
    return QuaternionXyzw(positions.data());
  }
};

Solved Solve(const std::shared_ptr<const Skeleton>& skeleton, const Goal& goal,
             const Eigen::VectorXd& start) {
  Solved solved;
  solved.positions = start;
  LevenbergMarquardtSolver().Solve(IkProblem::Create(skeleton, {goal}).value(),
                                   {}, SolveStart::kWarm, solved.positions,
                                   solved.report);
  return solved;
}

// From neutral to `target`, which is swing about Y and Z and twist about X.
Solved SolveBall(const JointLimits& limits, const Eigen::Quaterniond& target) {
  const auto skeleton = BallJoint(limits);
  return Solve(skeleton, RotationGoalFor("ball", target),
               NeutralPositions(*skeleton));
}

Eigen::Quaterniond Swing(double angle_rad) {
  return ExpRotation({0, 0.6 * angle_rad, 0.8 * angle_rad});
}
Eigen::Quaterniond Twist(double angle_rad) {
  return ExpRotation({angle_rad, 0, 0});
}

JointLimits Cone(double swing_rad) {
  JointLimits limits;
  limits.swing_cone_rad = swing_rad;
  return limits;
}

JointLimits TwistRange(double lower_rad, double upper_rad) {
  JointLimits limits;
  limits.twist_lower_rad = lower_rad;
  limits.twist_upper_rad = upper_rad;
  return limits;
}

TEST(BallLimitTest, InsideTheConeIsReached) {
  const Solved solved = SolveBall(Cone(0.5), Swing(0.45));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_THAT(solved.report.limited_joints, IsEmpty());
}

TEST(BallLimitTest, OutsideTheConeStallsOnIt) {
  const Solved solved = SolveBall(Cone(0.5), Swing(1.25));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kStalledAtLimits);
  EXPECT_THAT(solved.report.limited_joints, ElementsAre(0));
  EXPECT_NEAR(solved.report.rotation_errors_rad[0], 0.75, 1e-4);
  EXPECT_LE(AngleBetween(solved.rotation(), Swing(0.5)), 1e-3);
}

TEST(BallLimitTest, TwistIsFreeInACone) {
  const Solved solved = SolveBall(Cone(0.5), Swing(0.3) * Twist(2));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
}

TEST(BallLimitTest, NoSwingAtAll) {
  const Solved twisted = SolveBall(Cone(0), Twist(1));
  EXPECT_EQ(twisted.report.outcome, SolveOutcome::kConverged);
  const Solved swung = SolveBall(Cone(0), Swing(0.75));
  EXPECT_EQ(swung.report.outcome, SolveOutcome::kStalledAtLimits);
  EXPECT_NEAR(swung.report.rotation_errors_rad[0], 0.75, 1e-4);
}

TEST(BallLimitTest, TwistRangeFromBothSides) {
  EXPECT_EQ(SolveBall(TwistRange(-0.5, 1), Twist(0.95)).report.outcome,
            SolveOutcome::kConverged);
  EXPECT_EQ(SolveBall(TwistRange(-0.5, 1), Twist(-0.45)).report.outcome,
            SolveOutcome::kConverged);
  const Solved above = SolveBall(TwistRange(-0.5, 1), Twist(1.5));
  EXPECT_EQ(above.report.outcome, SolveOutcome::kStalledAtLimits);
  EXPECT_NEAR(above.report.rotation_errors_rad[0], 0.5, 1e-4);
  const Solved below = SolveBall(TwistRange(-0.5, 1), Twist(-1.5));
  EXPECT_EQ(below.report.outcome, SolveOutcome::kStalledAtLimits);
  EXPECT_NEAR(below.report.rotation_errors_rad[0], 1, 1e-4);
  EXPECT_THAT(below.report.limited_joints, ElementsAre(0));
}

TEST(BallLimitTest, FrozenTwistSwings) {
  const Solved solved = SolveBall(TwistRange(0, 0), Swing(1));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
}

TEST(BallLimitTest, TwistRangeAcrossPi) {
  const auto skeleton = BallJoint(TwistRange(3, 3.5));
  Eigen::VectorXd start(4);
  StoreXyzw(Twist(3.1), start.data());
  const Solved solved =
      Solve(skeleton, RotationGoalFor("ball", Twist(-2.85)), start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  const Solved stalled =
      Solve(skeleton, RotationGoalFor("ball", Twist(-2.5)), start);
  EXPECT_EQ(stalled.report.outcome, SolveOutcome::kStalledAtLimits);
  EXPECT_NEAR(stalled.report.rotation_errors_rad[0], 2 * M_PI - 2.5 - 3.5,
              1e-4);
}

// A whole turn or more is no limit, wherever it begins.
TEST(BallLimitTest, WholeTurnsOfTwistAreFree) {
  for (const JointLimits& limits :
       {TwistRange(0, 2 * M_PI), TwistRange(-2 * M_PI, 0),
        TwistRange(-M_PI, M_PI), TwistRange(-2 * M_PI, 2 * M_PI)}) {
    for (double twist : {-3.0, -0.5, 0.5, 3.0}) {
      const Solved solved = SolveBall(limits, Swing(0.3) * Twist(twist));
      EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged)
          << *limits.twist_lower_rad << " " << twist;
      EXPECT_THAT(solved.report.limited_joints, IsEmpty());
    }
  }
}

// A side that is not given ends at half a turn.
TEST(BallLimitTest, OneSidedTwistRanges) {
  JointLimits above;
  above.twist_lower_rad = -0.5;
  EXPECT_EQ(SolveBall(above, Twist(2)).report.outcome,
            SolveOutcome::kConverged);
  EXPECT_EQ(SolveBall(above, Twist(-1)).report.outcome,
            SolveOutcome::kStalledAtLimits);
  JointLimits below;
  below.twist_upper_rad = 0.5;
  EXPECT_EQ(SolveBall(below, Twist(-2)).report.outcome,
            SolveOutcome::kConverged);
  EXPECT_EQ(SolveBall(below, Twist(1)).report.outcome,
            SolveOutcome::kStalledAtLimits);
}

// Sliding along the cone's edge, not sticking where it is first met.
TEST(BallLimitTest, SlidesAlongTheCone) {
  const auto skeleton = BallJoint(Cone(0.5));
  Eigen::VectorXd start(4);
  StoreXyzw(ExpRotation({0, 0.5, 0}), start.data());
  const Eigen::Vector3d target =
      ExpRotation({0, 0, 0.5}) * Eigen::Vector3d::UnitX();
  // The image of X is a point to reach.
  SkeletonBuilder builder;
  RigidTransform tip;
  tip.translation = {1, 0, 0};
  const auto arm = builder.AddJoint(skeleton->joint(0))
                       .AddEndEffector({"tip", "ball", tip})
                       .Build()
                       .value();
  const Solved solved = Solve(arm, PositionGoalFor("tip", target), start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_LE(LimitExcess(*arm, solved.positions, nullptr), kOnBound);
}

// A driven joint whose follower may turn less than it.
std::shared_ptr<const Skeleton> LimitedFollower(double multiplier) {
  Joint driver;
  driver.id = "driver";
  driver.type = JointType::kRevolute;
  driver.axis = Eigen::Vector3d::UnitZ();
  driver.limits.lower = {-2};
  driver.limits.upper = {2};
  Joint follower = driver;
  follower.id = "follower";
  follower.parent_id = "driver";
  follower.mimic = Mimic{"driver", multiplier, 0};
  follower.limits.lower = {-0.75};
  follower.limits.upper = {0.5};
  return SkeletonBuilder().AddJoint(driver).AddJoint(follower).Build().value();
}

TEST(FollowerLimitTest, BoundsTheDriver) {
  for (double way : {-1.8, 1.8}) {
    const Solved solved =
        Solve(LimitedFollower(-2),
              RotationGoalFor("driver", ExpRotation({0, 0, way})),
              Eigen::VectorXd::Constant(1, 0.1));
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kStalledAtLimits);
    EXPECT_EQ(solved.positions[0], way < 0 ? -0.25 : 0.375);
    EXPECT_THAT(solved.report.limited_joints, ElementsAre(0));
  }
}

TEST(FollowerLimitTest, BothAreNamedWhereBothMove) {
  const Solved solved = Solve(
      LimitedFollower(1), RotationGoalFor("follower", ExpRotation({0, 0, 1.8})),
      Eigen::VectorXd::Constant(1, 0.1));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kStalledAtLimits);
  EXPECT_EQ(solved.positions[0], 0.5);
  EXPECT_THAT(solved.report.limited_joints, ElementsAre(0, 1));
}

}  // namespace
}  // namespace gelenk
