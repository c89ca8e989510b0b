// What the solver promises on small mechanisms whose answer is known. Random
// ones are in levenberg_marquardt_reach_test.cc.
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/base/number_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "absl/strings/str_cat.h"
#include "gelenk/base/number_check.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::PandaArm;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::PoseGoalFor;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::RotationGoalFor;
using ::testing::DoubleEq;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct Solved {
  Eigen::VectorXd positions;
  SolveReport report;
};

Solved Solve(const IkProblem& problem, const Eigen::VectorXd& start,
             const SolverOptions& options = {},
             SolveStart from = SolveStart::kWarm) {
  Solved solved;
  solved.positions = start;
  LevenbergMarquardtSolver solver;
  solver.Solve(problem, options, from, solved.positions, solved.report);
  return solved;
}

Solved Solve(const std::shared_ptr<const Skeleton>& skeleton,
             std::vector<Goal> goals, const Eigen::VectorXd& start,
             const SolverOptions& options = {},
             SolveStart from = SolveStart::kWarm) {
  return Solve(IkProblem::Create(skeleton, std::move(goals)).value(), start,
               options, from);
}

// Joints of one type in a row, each one metre along X from the one before;
// "tip" is the end.
std::shared_ptr<const Skeleton> Chain(const std::vector<Joint>& like) {
  SkeletonBuilder builder;
  RigidTransform link;
  for (size_t i = 0; i < like.size(); ++i) {
    Joint joint = like[i];
    joint.id = absl::StrCat("j", i);
    joint.parent_id = i == 0 ? "" : absl::StrCat("j", i - 1);
    joint.parent_from_joint = link;
    builder.AddJoint(joint);
    link.translation = {1, 0, 0};
  }
  builder.AddEndEffector({"tip", absl::StrCat("j", like.size() - 1), link});
  return builder.Build().value();
}

Joint HingeZ() {
  Joint joint;
  joint.type = JointType::kRevolute;
  joint.axis = Eigen::Vector3d::UnitZ();
  return joint;
}

Joint SliderX() {
  Joint joint;
  joint.type = JointType::kPrismatic;
  return joint;
}

Joint Ball() {
  Joint joint;
  joint.type = JointType::kSpherical;
  return joint;
}

// A trunk with two arms, stretched along X in the neutral pose.
std::shared_ptr<const Skeleton> TwoArms() {
  SkeletonBuilder builder;
  Joint root = Ball();
  root.id = "root";
  builder.AddJoint(root);
  for (const std::string side : {"left", "right"}) {
    Joint upper = Ball();
    upper.id = side + " upper";
    upper.parent_id = "root";
    Joint lower = HingeZ();
    lower.id = side + " lower";
    lower.parent_id = upper.id;
    lower.parent_from_joint.translation = {1, 0, 0};
    RigidTransform tip;
    tip.translation = {1, 0, 0};
    builder.AddJoint(upper).AddJoint(lower).AddEndEffector(
        {side + " tip", lower.id, tip});
  }
  return builder.Build().value();
}

TEST(LevenbergMarquardtTest, WithoutGoalsThePoseStays) {
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(7, -0.5);
  const Solved solved = Solve(PandaArm(), {}, start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(solved.positions[0], start[0]);
  EXPECT_THAT(solved.report.position_errors_m, IsEmpty());
}

TEST(LevenbergMarquardtTest, APoseThatIsThereStaysBitByBit) {
  const auto panda = PandaArm();
  Eigen::VectorXd start(7);
  start << 0.1, 0.3, -0.2, -1.5, 0.4, 1.8, 0.6;
  const Solved solved = Solve(
      panda, {PoseGoalFor("tip", EffectorPose(*panda, start, "tip"))}, start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(solved.report.iteration_count, 0);
  EXPECT_EQ(solved.positions, start);
  EXPECT_EQ(solved.report.change, 0);
}

// Closest poses creep up on the optimum; the solver stops where six iterations
// gain less than 1e-5 of the energy.
constexpr double kClosest_m = 1e-3;

TEST(LevenbergMarquardtTest, OutOfReachIsUnreachableWithItsDistance) {
  const auto arm = PlanarChain({1, 2, 0}, {1, 1, 1});
  const Eigen::Vector3d target(9, 8, 0);
  for (SolveStart from : {SolveStart::kWarm, SolveStart::kCold}) {
    const Solved solved =
        Solve(arm, {PositionGoalFor("tip", target)},
              Eigen::Vector3d(0.1, 0.5, -0.3), SolverOptions(), from);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
    EXPECT_NEAR(solved.report.position_errors_m[0], 10 - 3, kClosest_m);
    EXPECT_THAT(solved.report.limited_joints, IsEmpty());
    // Stretched towards it.
    const Eigen::Vector3d tip =
        EffectorPose(*arm, solved.positions, "tip").translation;
    EXPECT_LE((tip - Eigen::Vector3d(1 + 2.4, 2 + 1.8, 0)).norm(), 0.1);
  }
}

TEST(LevenbergMarquardtTest, TooCloseIsUnreachableToo) {
  const auto arm = PlanarChain({0, 0, 0}, {3, 1});
  const Solved solved = Solve(arm, {PositionGoalFor("tip", {0.5, 0, 0})},
                              Eigen::Vector2d(0.1, 2));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
  EXPECT_NEAR(solved.report.position_errors_m[0], 2 - 0.5, kClosest_m);
}

TEST(LevenbergMarquardtTest, FarTargetsGiveFinitePoses) {
  const auto arm = PlanarChain({0, 0, 0}, {1, 1, 1});
  for (double distance : {1e3, 1e6, kLargestNumber}) {
    const Solved solved = Solve(arm, {PositionGoalFor("tip", {0, distance, 0})},
                                Eigen::Vector3d(0.1, 0.5, -0.3));
    EXPECT_TRUE(solved.positions.allFinite()) << distance;
    EXPECT_NE(solved.report.outcome, SolveOutcome::kConverged) << distance;
    EXPECT_NEAR(solved.report.position_errors_m[0] / distance, 1, 0.01)
        << distance;
  }
}

TEST(LevenbergMarquardtTest, LimitsInTheWayAreNamed) {
  Joint elbow = HingeZ();
  elbow.limits.lower = {-0.25};
  elbow.limits.upper = {0.5};
  const auto arm = Chain({HingeZ(), elbow});
  // Only a sharper elbow would bring the tip nearer.
  const Solved solved = Solve(arm, {PositionGoalFor("tip", {0.5, 0, 0})},
                              Eigen::Vector2d(-0.1, 0.2));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kStalledAtLimits);
  EXPECT_THAT(solved.report.limited_joints, ElementsAre(1));
  EXPECT_EQ(solved.positions[1], 0.5);
  const double reach = 2 * std::cos(0.25);
  EXPECT_NEAR(solved.report.position_errors_m[0], reach - 0.5, kClosest_m);
}

TEST(LevenbergMarquardtTest, ALimitThatIsNotInTheWayDoesNotStall) {
  Joint elbow = HingeZ();
  elbow.limits.lower = {-0.25};
  elbow.limits.upper = {0.5};
  const auto arm = Chain({HingeZ(), elbow, HingeZ()});
  const Eigen::Vector3d at_limit(0.3, 0.5, 0.7);
  const Solved solved =
      Solve(arm, {PoseGoalFor("tip", EffectorPose(*arm, at_limit, "tip"))},
            Eigen::Vector3d(0.2, 0.3, 0.8));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
}

TEST(LevenbergMarquardtTest, GoalsOfWeightZeroAreOff) {
  const auto arm = PlanarChain({0, 0, 0}, {1, 1});
  Goal off = PositionGoalFor("j1", {0, -1, 0});
  off.weight = 0;
  Goal elsewhere = PositionGoalFor("j1", {7, 8, 9});
  elsewhere.weight = 0;
  const Goal on = PositionGoalFor("tip", {1, 1, 0});
  const Eigen::Vector2d start(0.3, 0.9);
  const Solved both = Solve(arm, {off, on}, start);
  EXPECT_EQ(both.report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(both.report.position_errors_m[0], 0);
  EXPECT_LE(both.report.position_errors_m[1],
            SolverOptions().position_tolerance_m);
  EXPECT_EQ(both.positions, Solve(arm, {elsewhere, on}, start).positions);
}

TEST(LevenbergMarquardtTest, JointsOfGoalsThatAreOffStay) {
  const auto body = TwoArms();
  Goal off = PositionGoalFor("right tip", {0, 0, 2});
  off.weight = 0;
  const Eigen::VectorXd start = NeutralPositions(*body);
  const Solved solved =
      Solve(body, {PositionGoalFor("left tip", {0, 9, 0}), off}, start,
            SolverOptions(), SolveStart::kCold);
  EXPECT_GT(solved.report.restart_count, 0);
  const int upper = body->FindJoint("right upper");
  const int offset = body->span(upper).position_offset;
  EXPECT_EQ(solved.positions.segment(offset, 5), start.segment(offset, 5));
}

TEST(LevenbergMarquardtTest, WeightsCanBeSwitched) {
  const auto arm = PlanarChain({0, 0, 0}, {1, 1});
  IkProblem problem =
      IkProblem::Create(arm, {PositionGoalFor("tip", {1, 1, 0})}).value();
  const Eigen::Vector2d start(0.3, 0.9);
  problem.SetWeight(0, 0);
  EXPECT_EQ(Solve(problem, start).positions, start);
  problem.SetWeight(0, 2);
  EXPECT_NE(Solve(problem, start).positions, start);
}

// Of two contradicting wishes the weighted mean is the least-squares answer.
TEST(LevenbergMarquardtTest, WeightsShareTheError) {
  const auto slider = Chain({SliderX()});
  Goal left = PositionGoalFor("tip", {0, 0, 0});
  Goal right = PositionGoalFor("tip", {4, 0, 0});
  left.id = "left";
  right.weight = 3;
  const Solved solved =
      Solve(slider, {left, right}, Eigen::VectorXd::Constant(1, 0.5));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
  EXPECT_NEAR(solved.report.position_errors_m[0], 3, kClosest_m);
  EXPECT_NEAR(solved.report.position_errors_m[1], 1, kClosest_m);
}

TEST(LevenbergMarquardtTest, MaskedAxesDoNotCount) {
  const auto arm = PlanarChain({0, 0, 0}, {1, 1});
  const Eigen::Vector2d start(0.3, 0.9);
  Goal goal = PositionGoalFor("tip", {-50, 1.25, 7});
  std::get<PositionGoal>(goal.kind).axes = {false, true, false};
  const Solved solved = Solve(arm, {goal}, start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_LE(solved.report.position_errors_m[0], 1e-4);
  EXPECT_NEAR(EffectorPose(*arm, solved.positions, "tip").translation.y(), 1.25,
              1e-4);
}

TEST(LevenbergMarquardtTest, PosesHaveAMaskForTranslationOnly) {
  const auto arm = PlanarChain({0, 0, 0}, {1, 1, 1});
  const Eigen::Vector3d truth(0.3, 0.9, -0.4);
  Goal goal = PoseGoalFor("tip", EffectorPose(*arm, truth, "tip"));
  PoseGoal& kind = std::get<PoseGoal>(goal.kind);
  kind.axes = {true, false, true};
  kind.world_pose.translation.y() = 99;
  const Solved solved = Solve(arm, {goal}, Eigen::Vector3d(0.2, 1.1, -0.3));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  const RigidTransform tip = EffectorPose(*arm, solved.positions, "tip");
  EXPECT_NEAR(tip.translation.x(), kind.world_pose.translation.x(), 1e-4);
  EXPECT_LE(AngleBetween(tip.rotation, kind.world_pose.rotation), 1e-3);
}

TEST(LevenbergMarquardtTest, AllAxesMaskedIsNoWish) {
  const auto arm = PlanarChain({0, 0, 0}, {1, 1});
  Goal goal = PositionGoalFor("tip", {7, 7, 7});
  std::get<PositionGoal>(goal.kind).axes = {false, false, false};
  const Eigen::Vector2d start(0.3, 0.9);
  const Solved solved = Solve(arm, {goal}, start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(solved.positions, start);
}

TEST(LevenbergMarquardtTest, ARotationThatCountsNothingIsNoWish) {
  const auto arm = PlanarChain({0, 0, 0}, {1, 1});
  Goal goal = PoseGoalFor("tip", {});
  PoseGoal& kind = std::get<PoseGoal>(goal.kind);
  kind.world_pose.translation = {1, 1, 0};
  kind.world_pose.rotation = QuaternionXyzw(1, 0, 0, 0);
  kind.rotation_scale_m_per_rad = 0;
  const Solved solved = Solve(arm, {goal}, Eigen::Vector2d(0.3, 0.9));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(solved.report.rotation_errors_rad[0], 0);
}

TEST(LevenbergMarquardtTest, RotationErrorsAreAngles) {
  Joint hinge = HingeZ();
  hinge.limits.lower = {-0.5};
  hinge.limits.upper = {0.5};
  const auto arm = Chain({hinge});
  for (double angle : {1.0, 2.0, 3.0}) {
    const Goal goal = RotationGoalFor("tip", ExpRotation({0, 0, angle}));
    const Solved solved = Solve(arm, {goal}, Eigen::VectorXd::Zero(1));
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kStalledAtLimits);
    EXPECT_NEAR(solved.report.rotation_errors_rad[0], angle - 0.5, 1e-6);
    EXPECT_EQ(solved.report.position_errors_m[0], 0);
  }
}

// Half a turn away every axis across is as good.
TEST(LevenbergMarquardtTest, HalfATurnAwayIsReached) {
  const auto arm = Chain({Ball()});
  for (const Eigen::Vector4d& xyzw :
       {Eigen::Vector4d(1, 0, 0, 0), Eigen::Vector4d(0, 1, 0, 0),
        Eigen::Vector4d(0, 0, 1, 0), Eigen::Vector4d(0.6, 0, 0.8, 0)}) {
    const Goal goal = RotationGoalFor("tip", QuaternionXyzw(xyzw.data()));
    const Solved solved = Solve(arm, {goal}, NeutralPositions(*arm));
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  }
}

TEST(LevenbergMarquardtTest, TargetsAreInTheWorldTheActorStandsIn) {
  const auto arm = PlanarChain({0, 0, 0}, {1, 1});
  IkProblem problem =
      IkProblem::Create(arm, {PositionGoalFor("tip", {10, 6, 2})}).value();
  RigidTransform world_from_skeleton;
  world_from_skeleton.translation = {10, 5, 2};
  world_from_skeleton.rotation =
      QuaternionXyzw(0, 0, std::sqrt(0.5), std::sqrt(0.5));
  problem.SetWorldFromSkeleton(world_from_skeleton);
  const Solved solved = Solve(problem, Eigen::Vector2d(0.3, 0.9));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  const RigidTransform tip =
      world_from_skeleton * EffectorPose(*arm, solved.positions, "tip");
  EXPECT_LE((tip.translation - Eigen::Vector3d(10, 6, 2)).norm(), 1e-4);
}

TEST(LevenbergMarquardtTest, WhatCannotMoveIsUnreachable) {
  Joint root;
  root.id = "root";
  Joint arm = HingeZ();
  arm.id = "arm";
  arm.parent_id = "root";
  const auto skeleton =
      SkeletonBuilder().AddJoint(root).AddJoint(arm).Build().value();
  const Solved solved = Solve(skeleton, {PositionGoalFor("root", {3, 4, 0})},
                              Eigen::VectorXd::Constant(1, 0.7));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
  EXPECT_THAT(solved.report.position_errors_m, ElementsAre(DoubleEq(5)));
  EXPECT_EQ(solved.positions[0], 0.7);
}

TEST(LevenbergMarquardtTest, JointsThatMoveNoGoalStay) {
  const auto body = TwoArms();
  Eigen::VectorXd start = NeutralPositions(*body);
  start[body->span(body->FindJoint("right lower")).position_offset] = 0.7;
  start[body->span(body->FindJoint("left lower")).position_offset] = 0.4;
  // Out of reach, so that every restart is used up.
  for (const Eigen::Vector3d& target :
       {Eigen::Vector3d(1, 1, 0.5), Eigen::Vector3d(0, 9, 0)}) {
    const Solved solved = Solve(body, {PositionGoalFor("left tip", target)},
                                start, SolverOptions(), SolveStart::kCold);
    const int upper = body->FindJoint("right upper");
    const int offset = body->span(upper).position_offset;
    EXPECT_EQ(solved.positions.segment(offset, 5), start.segment(offset, 5));
  }
}

TEST(LevenbergMarquardtTest, AStartOutsideItsLimitsIsMovedInside) {
  Joint hinge = HingeZ();
  hinge.limits.lower = {-0.5};
  hinge.limits.upper = {0.5};
  const auto arm = Chain({hinge, hinge});
  const Solved solved =
      Solve(arm, {PositionGoalFor("j1", {std::cos(0.2), std::sin(0.2), 0})},
            Eigen::Vector2d(3, -2));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_NEAR(solved.positions[0], 0.2, 1e-4);
  EXPECT_EQ(solved.positions[1], -0.5);
}

TEST(LevenbergMarquardtTest, BudgetOfNoIterationsOnlyLooks) {
  const auto arm = PlanarChain({0, 0, 0}, {1, 1});
  const Eigen::Vector2d start(0.3, 0.9);
  SolverOptions options;
  options.max_iterations = 0;
  const Solved away =
      Solve(arm, {PositionGoalFor("tip", {1, 1, 0})}, start, options);
  EXPECT_EQ(away.report.outcome, SolveOutcome::kIterationLimit);
  EXPECT_EQ(away.positions, start);
  const Solved there = Solve(
      arm,
      {PositionGoalFor("tip", EffectorPose(*arm, start, "tip").translation)},
      start, options);
  EXPECT_EQ(there.report.outcome, SolveOutcome::kConverged);
}

TEST(LevenbergMarquardtTest, BudgetOfIterationsIsKept) {
  const auto arm = PlanarChain({0, 0, 0}, {1, 1, 1});
  SolverOptions options;
  options.max_iterations = 2;
  const Solved solved = Solve(arm, {PositionGoalFor("tip", {-1, -1, 0})},
                              Eigen::Vector3d(1, 1, 1), options);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kIterationLimit);
  EXPECT_EQ(solved.report.iteration_count, 2);
}

TEST(LevenbergMarquardtTest, BudgetOfRestartsIsKept) {
  const auto arm = PlanarChain({0, 0, 0}, {1, 1, 1});
  // Above its plane, where no start leads.
  const Goal far = PositionGoalFor("tip", {1, 1, 9});
  const Eigen::Vector3d start(1, 1, 1);
  SolverOptions options;
  for (int restarts : {0, 1, 5}) {
    options.max_restarts = restarts;
    EXPECT_EQ(Solve(arm, {far}, start, options).report.restart_count, restarts);
  }
}

TEST(LevenbergMarquardtTest, StiffJointsMoveLess) {
  Joint stiff = HingeZ();
  stiff.stiffness = {100};
  const auto arm = Chain({stiff, HingeZ(), HingeZ()});
  const auto even = Chain({HingeZ(), HingeZ(), HingeZ()});
  const Eigen::Vector3d start(0.1, 0.5, 0.5);
  const Goal goal = PositionGoalFor("tip", {1.7, 1.9, 0});
  const double moved =
      std::abs(Solve(arm, {goal}, start).positions[0] - start[0]);
  const double moved_evenly =
      std::abs(Solve(even, {goal}, start).positions[0] - start[0]);
  EXPECT_LT(moved, moved_evenly);
}

// Nothing resists the roll, and it does not move the tip.
TEST(LevenbergMarquardtTest, JointsWithoutStiffnessAreHeld) {
  Joint slider = SliderX();
  slider.id = "slider";
  slider.stiffness = {0};
  Joint roll;
  roll.id = "roll";
  roll.parent_id = "slider";
  roll.type = JointType::kRevolute;
  roll.stiffness = {0};
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 0, 0),
        Eigen::Vector3d(0.48, 0.6, 0.64)}) {
    roll.axis = axis;
    RigidTransform tip;
    tip.translation = 2 * axis;
    const auto arm = SkeletonBuilder()
                         .AddJoint(slider)
                         .AddJoint(roll)
                         .AddEndEffector({"tip", "roll", tip})
                         .Build()
                         .value();
    for (double way : {0.5, -3.0}) {
      const Eigen::Vector3d target = 2 * axis + Eigen::Vector3d(way, 0, 0);
      const Solved solved = Solve(arm, {PositionGoalFor("tip", target)},
                                  Eigen::Vector2d(0, 0.25));
      EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
      EXPECT_NEAR(solved.positions[0], way, 1e-4);
      EXPECT_NEAR(solved.positions[1], 0.25, 1e-6);
    }
  }
}

TEST(LevenbergMarquardtTest, QuaternionsStayInTheHemisphereOfTheStart) {
  const auto body = TwoArms();
  for (double sign : {1.0, -1.0}) {
    const Eigen::VectorXd start = sign * NeutralPositions(*body);
    for (SolveStart from : {SolveStart::kWarm, SolveStart::kCold}) {
      for (double angle = 0.5; angle < 6.3; angle += 0.5) {
        RigidTransform target;
        target.rotation = ExpRotation({0.6 * angle, 0, 0.8 * angle});
        target.translation = target.rotation * Eigen::Vector3d(1.5, 0.5, 0);
        const Solved solved = Solve(body, {PoseGoalFor("left tip", target)},
                                    start, SolverOptions(), from);
        for (int at : {0, 4}) {
          EXPECT_GE(solved.positions.segment<4>(at).dot(start.segment<4>(at)),
                    0);
        }
      }
    }
  }
}

TEST(LevenbergMarquardtTest, ChangeIsMeasuredFromTheStart) {
  const auto slider = Chain({SliderX()});
  const Solved solved = Solve(slider, {PositionGoalFor("tip", {4, 0, 0})},
                              Eigen::VectorXd::Constant(1, 0.5));
  EXPECT_DOUBLE_EQ(solved.report.change, solved.positions[0] - 0.5);
}

TEST(LevenbergMarquardtTest, DetailDecidesWhatIsReported) {
  Joint hinge = HingeZ();
  hinge.limits.lower = {-0.5};
  hinge.limits.upper = {0.5};
  const auto arm = Chain({hinge});
  const Goal goal = RotationGoalFor("tip", ExpRotation({0, 0, 1}));
  const Eigen::VectorXd start = Eigen::VectorXd::Zero(1);
  SolverOptions options;
  options.detail = ReportDetail::kBrief;
  const SolveReport brief = Solve(arm, {goal}, start, options).report;
  EXPECT_THAT(brief.limited_joints, IsEmpty());
  EXPECT_EQ(brief.change, 0);
  options.detail = ReportDetail::kDiagnosis;
  const SolveReport diagnosis = Solve(arm, {goal}, start, options).report;
  EXPECT_THAT(diagnosis.limited_joints, ElementsAre(0));
  EXPECT_EQ(diagnosis.rank, 1);
  EXPECT_EQ(diagnosis.free_velocity_count, 0);
  EXPECT_EQ(brief.outcome, diagnosis.outcome);
}

TEST(LevenbergMarquardtTest, AReportIsWrittenAnew) {
  Joint hinge = HingeZ();
  hinge.limits.lower = {-0.5};
  hinge.limits.upper = {0.5};
  const auto arm = Chain({hinge});
  const IkProblem far =
      IkProblem::Create(arm, {RotationGoalFor("tip", ExpRotation({0, 0, 1})),
                              PositionGoalFor("j0", {1, 0, 0})})
          .value();
  const IkProblem near =
      IkProblem::Create(arm, {RotationGoalFor("tip", ExpRotation({0, 0, 0.2}))})
          .value();
  LevenbergMarquardtSolver solver;
  SolveReport report;
  Eigen::VectorXd positions = Eigen::VectorXd::Zero(1);
  solver.Solve(far, {}, SolveStart::kCold, positions, report);
  positions.setZero();
  solver.Solve(near, {}, SolveStart::kWarm, positions, report);
  EXPECT_EQ(report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(report.restart_count, 0);
  EXPECT_EQ(report.position_errors_m.size(), 1u);
  EXPECT_THAT(report.position_errors_m, Each(0.0));
  EXPECT_THAT(report.limited_joints, IsEmpty());
}

}  // namespace
}  // namespace gelenk
