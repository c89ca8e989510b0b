#include "gelenk/ik/goals/half_space_goal.h"

#include <gtest/gtest.h>

#include <vector>

#include "gelenk/ik/batch_solver.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/skeleton/pose.h"
#include "tests/core/ik/goals/solve_goals.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"

namespace gelenk {
namespace {

using ::gelenk::testing::GoalOf;
using ::gelenk::testing::HingedLegAt;
using ::gelenk::testing::Leg;
using ::gelenk::testing::OriginOf;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Solved;
using ::gelenk::testing::SolveGoals;

constexpr double kTolerance_m = 1e-4;

TEST(HalfSpaceGoalTest, DoesNothingOnTheFreeSide) {
  const auto leg = Leg(true);
  const Eigen::VectorXd start = HingedLegAt(0.4, 0.8);
  const double height = OriginOf(*leg, start, "sole").y();
  const Solved solved = SolveGoals(
      leg, {GoalOf(HalfSpaceGoal{"sole", {0, 1, 0}, height - 1e-6})}, start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(solved.report.iteration_count, 0);
  EXPECT_EQ(solved.report.position_errors_m[0], 0);
  EXPECT_EQ(solved.positions, start);
}

TEST(HalfSpaceGoalTest, LiftsWhatIsBehind) {
  const auto leg = Leg(true);
  const Eigen::VectorXd start = HingedLegAt(0.4, 0.8);
  const double height = OriginOf(*leg, start, "sole").y();
  const HalfSpaceGoal ground = {"sole", {0, 1, 0}, height + 0.01};
  const Solved solved = SolveGoals(leg, {GoalOf(ground)}, start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  const double reached = OriginOf(*leg, solved.positions, "sole").y();
  EXPECT_GE(reached, height + 0.01 - kTolerance_m);
  // No further than needed, but for the curve of the way there.
  EXPECT_LE(reached, height + 0.01 + 1e-3);
}

// A long step is not to throw it far beyond, whoever solves.
TEST(HalfSpaceGoalTest, EndsOnThePlaneFromFarBehindIt) {
  const auto leg = Leg(true);
  const Eigen::VectorXd start = HingedLegAt(0.4, 0.8);
  const double height = OriginOf(*leg, start, "sole").y();
  LevenbergMarquardtSolver solver;
  for (double depth : {0.02, 0.1, 0.3, 0.5}) {
    const Goal ground =
        GoalOf(HalfSpaceGoal{"sole", {0, 1, 0}, height + depth});
    const Solved solved = SolveGoals(leg, {ground}, start);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
    EXPECT_NEAR(OriginOf(*leg, solved.positions, "sole").y(), height + depth,
                1e-3)
        << depth;
    Eigen::VectorXd directly = start;
    SolveReport report;
    solver.Solve(IkProblem::Create(leg, {ground}).value(), {},
                 SolveStart::kWarm, directly, report);
    EXPECT_EQ(directly, solved.positions) << depth;
    EXPECT_EQ(report.iteration_count, solved.report.iteration_count);
  }
}

TEST(HalfSpaceGoalTest, EndsOnThePlaneInBatches) {
  const auto leg = Leg(true);
  const Eigen::VectorXd start = HingedLegAt(0.4, 0.8);
  const double height = OriginOf(*leg, start, "sole").y();
  std::vector<GoalTarget> targets;
  for (double depth : {0.02, 0.1, 0.3, 0.5}) {
    targets.push_back(Plane{{0, 1, 0}, height + depth});
  }
  IkProblem problem =
      IkProblem::Create(leg, {GoalOf(HalfSpaceGoal{"sole"})}).value();
  Eigen::MatrixXd positions = start.replicate(1, 4);
  BatchReport report;
  BatchSolver().Solve(problem, targets, {}, SolveStart::kWarm, positions,
                      report);
  for (int c = 0; c < 4; ++c) {
    EXPECT_EQ(report.outcomes[c], SolveOutcome::kConverged);
    EXPECT_NEAR(OriginOf(*leg, positions.col(c), "sole").y(),
                std::get<Plane>(targets[c]).offset_m, 1e-3);
  }
}

// What another goal wants on the free side is no overshoot.
TEST(HalfSpaceGoalTest, GoesBeyondThePlaneWhereAnotherGoalWantsIt) {
  const auto leg = Leg(true);
  const Eigen::VectorXd start = HingedLegAt(0.4, 0.8);
  const Eigen::Vector3d sole = OriginOf(*leg, start, "sole");
  const Eigen::Vector3d target = sole + Eigen::Vector3d(0.02, 0.3, 0.1);
  const Solved solved =
      SolveGoals(leg,
                 {PositionGoalFor("sole", target),
                  GoalOf(HalfSpaceGoal{"sole", {0, 1, 0}, sole.y() + 0.1})},
                 start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_LT((OriginOf(*leg, solved.positions, "sole") - target).norm(),
            kTolerance_m);
}

TEST(HalfSpaceGoalTest, DepthIsWhatIsLeft) {
  // A link of 1 m cannot lift its tip above 1 m.
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1});
  const Solved solved =
      SolveGoals(chain, {GoalOf(HalfSpaceGoal{"tip", {0, 1, 0}, 1.5})},
                 Eigen::VectorXd::Constant(1, 0.2));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
  EXPECT_NEAR(solved.report.position_errors_m[0], 0.5, 1e-4);
  EXPECT_NEAR(solved.positions[0], M_PI / 2, 1e-2);
}

// A foot that is asked into the ground stays on it, above its target: the
// half-space gives way by its share of the weights.
TEST(HalfSpaceGoalTest, SharesWithAGoalBehindThePlane) {
  const auto leg = Leg(true);
  const double ground = -0.8;
  for (double weight : {1.0, 100.0, 1e4}) {
    const Solved solved =
        SolveGoals(leg,
                   {PositionGoalFor("sole", {0.05, ground - 0.1, 0.1}),
                    GoalOf(HalfSpaceGoal{"sole", {0, 1, 0}, ground}, weight)},
                   HingedLegAt(0.4, 0.8));
    const Eigen::Vector3d sole = OriginOf(*leg, solved.positions, "sole");
    EXPECT_NEAR(ground - sole.y(), 0.1 / (1 + weight), 1e-3) << weight;
    EXPECT_NEAR(sole.x(), 0.05, 1e-3);
    EXPECT_NEAR(sole.z(), 0.1, 1e-3);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
  }
}

// A step onto the ground and along it, a target a frame.
TEST(HalfSpaceGoalTest, AStreamThatTouchesDownIsSmooth) {
  const auto leg = Leg(true);
  const double ground = -0.8;
  Eigen::VectorXd q = HingedLegAt(0.4, 0.8);
  Eigen::Vector3d last = OriginOf(*leg, q, "sole");
  for (int frame = 0; frame < 200; ++frame) {
    const Eigen::Vector3d target(0, ground + 0.1 * std::cos(0.05 * frame),
                                 0.15 - 0.0015 * frame);
    const Solved solved =
        SolveGoals(leg,
                   {PositionGoalFor("sole", target),
                    GoalOf(HalfSpaceGoal{"sole", {0, 1, 0}, ground}, 1000)},
                   q);
    q = solved.positions;
    const Eigen::Vector3d sole = OriginOf(*leg, q, "sole");
    EXPECT_GT(sole.y(), ground - 3e-4) << frame;
    EXPECT_NEAR(sole.y(), std::max(ground, target.y()), 3e-4) << frame;
    EXPECT_LT((sole - last).norm(), frame > 0 ? 0.02 : 1) << frame;
    EXPECT_LE(solved.report.iteration_count, 24) << frame;
    last = sole;
  }
}

}  // namespace
}  // namespace gelenk
