// Levels of priority on a body: planted feet, the centre of mass, hands in each
// other's frame, postures, bounds of a frame.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "gelenk/ik/ik_solver.h"
#include "gelenk/kinematics/center_of_mass.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"
#include "tests/core/ik/goals/solve_goals.h"
#include "tests/testing/example_bodies.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random.h"
#include "tests/testing/random_goals.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::GoalOf;
using ::gelenk::testing::HingedLegAt;
using ::gelenk::testing::kGoalKindCount;
using ::gelenk::testing::Leg;
using ::gelenk::testing::OriginOf;
using ::gelenk::testing::PersonWithFingers;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomGoal;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::Solved;
using ::gelenk::testing::SolveGoals;
using ::gelenk::testing::StartNear;

constexpr double kDisturbance_m = 1e-6;
constexpr double kTolerance_m = 1e-4;
constexpr double kTolerance_rad = 1e-3;
constexpr double kOnLimit = 1e-9;

Eigen::Vector3d CenterOf(const Skeleton& skeleton,
                         const Eigen::VectorXd& positions) {
  WorldTransforms frames;
  ForwardKinematics(skeleton, positions, frames);
  return CenterOfMass().Compute(skeleton, frames);
}

class PrioritizedBodyTest : public ::testing::Test {
 protected:
  PrioritizedBodyTest() {
    Random random(5);
    // Nothing is quite straight.
    start_ = StartNear(random, *person_, NeutralPositions(*person_), 0.15);
  }

  // Both feet stay, at level 0.
  std::vector<Goal> Planted() const {
    return {GoalOf(PlantGoal{"left_sole"}), GoalOf(PlantGoal{"right_sole"})};
  }

  void ExpectPlanted(const Eigen::VectorXd& positions) const {
    for (const char* sole : {"left_sole", "right_sole"}) {
      const RigidTransform before = EffectorPose(*person_, start_, sole);
      const RigidTransform after = EffectorPose(*person_, positions, sole);
      EXPECT_LT((after.translation - before.translation).norm(),
                kDisturbance_m);
      EXPECT_LT(AngleBetween(after.rotation, before.rotation), kDisturbance_m);
    }
    EXPECT_LE(LimitExcess(*person_, positions, nullptr), kOnLimit);
  }

  std::shared_ptr<const Skeleton> person_ = PersonWithFingers();
  Eigen::VectorXd start_;
};

TEST_F(PrioritizedBodyTest, TheCentreOfMassMovesOverPlantedFeet) {
  const Eigen::Vector3d target =
      CenterOf(*person_, start_) + Eigen::Vector3d(0.06, -0.03, 0.03);
  std::vector<Goal> goals = Planted();
  goals.push_back(GoalOf(CenterOfMassGoal{target, {}}, 1, 1));
  const Solved solved = SolveGoals(person_, goals, start_);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_LT((CenterOf(*person_, solved.positions) - target).norm(),
            kTolerance_m);
  ExpectPlanted(solved.positions);
}

TEST_F(PrioritizedBodyTest, MaskedAxesOfTheCentreOfMassAreFree) {
  const Eigen::Vector3d before = CenterOf(*person_, start_);
  const Eigen::Vector3d target = before + Eigen::Vector3d(0.05, 30, 0.02);
  std::vector<Goal> goals = Planted();
  goals.push_back(GoalOf(CenterOfMassGoal{target, {true, false, true}}, 1, 1));
  const Solved solved = SolveGoals(person_, goals, start_);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  const Eigen::Vector3d after = CenterOf(*person_, solved.positions);
  EXPECT_NEAR(after.x(), target.x(), kTolerance_m);
  EXPECT_NEAR(after.z(), target.z(), kTolerance_m);
  EXPECT_LT(std::abs(after.y() - before.y()), 0.2);
  ExpectPlanted(solved.positions);
}

TEST_F(PrioritizedBodyTest, TheFeetStayThoughTheCentreOfMassIsOutOfReach) {
  const Eigen::Vector3d before = CenterOf(*person_, start_);
  const Eigen::Vector3d target = before + Eigen::Vector3d(3, 0, 0);
  std::vector<Goal> goals = Planted();
  goals.push_back(GoalOf(CenterOfMassGoal{target, {}}, 1, 1));
  SolverOptions options;
  options.max_iterations = 200;
  const Solved solved = SolveGoals(person_, goals, start_, options);
  EXPECT_NE(solved.report.outcome, SolveOutcome::kConverged);
  const double left = (CenterOf(*person_, solved.positions) - target).norm();
  EXPECT_NEAR(solved.report.position_errors_m[2], left, 1e-9);
  // It leans as far as its legs let it.
  EXPECT_LT(left, 2.2);
  EXPECT_GT(left, 1.5);
  ExpectPlanted(solved.positions);
}

TEST_F(PrioritizedBodyTest, TheCentreOfMassAloneNeedsNoSecondLevel) {
  const Eigen::Vector3d target =
      CenterOf(*person_, start_) + Eigen::Vector3d(0.4, 0.1, -0.3);
  const Solved solved =
      SolveGoals(person_, {GoalOf(CenterOfMassGoal{target, {}})}, start_);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_LT((CenterOf(*person_, solved.positions) - target).norm(),
            kTolerance_m);
}

TEST_F(PrioritizedBodyTest, OneHandInTheFrameOfTheOther) {
  Random random(8);
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::VectorXd truth = StartNear(random, *person_, start_, 0.3);
    const RigidTransform left_from_right =
        EffectorPose(*person_, truth, "left_palm").Inverse() *
        EffectorPose(*person_, truth, "right_palm");
    std::vector<Goal> goals = Planted();
    RelativeGoal relative;
    relative.reference_end_effector_id = "left_palm";
    relative.end_effector_id = "right_palm";
    relative.reference_from_end_effector = left_from_right;
    goals.push_back(GoalOf(relative, 1, 1));
    const Solved solved = SolveGoals(person_, goals, start_);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged) << trial;
    const RigidTransform reached =
        EffectorPose(*person_, solved.positions, "left_palm").Inverse() *
        EffectorPose(*person_, solved.positions, "right_palm");
    EXPECT_LT((reached.translation - left_from_right.translation).norm(),
              kTolerance_m);
    EXPECT_LT(AngleBetween(reached.rotation, left_from_right.rotation),
              kTolerance_rad);
    ExpectPlanted(solved.positions);
  }
}

// A posture of any weight takes nothing from the levels above it, and what they
// leave open is as near to it as can be: no small move that keeps them is
// nearer.
TEST_F(PrioritizedBodyTest, APostureBelowIsStrict) {
  const Eigen::Vector3d hand =
      OriginOf(*person_, start_, "left_palm") + Eigen::Vector3d(-0.1, 0.1, 0.1);
  for (double weight : {1e-3, 1.0, 1e3}) {
    std::vector<Goal> goals = Planted();
    goals.push_back(GoalOf(PositionGoal{"left_palm", hand, {}}, 1, 1));
    goals.push_back(
        GoalOf(PostureGoal{NeutralPositions(*person_), {}}, weight, 2));
    const Solved solved = SolveGoals(person_, goals, start_);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged) << weight;
    EXPECT_LT((OriginOf(*person_, solved.positions, "left_palm") - hand).norm(),
              kDisturbance_m)
        << weight;
    ExpectPlanted(solved.positions);
    // Fingers are free to be as the posture has them.
    const int joint = person_->FindJoint("left_index1");
    if (joint >= 0) {
      const int at = person_->span(joint).quaternion_offset;
      EXPECT_NEAR(std::abs(solved.positions[at + 3]), 1, 1e-6);
    }
  }
}

TEST_F(PrioritizedBodyTest, AFrameKeepsItsLargestStep) {
  const Eigen::Vector3d hand =
      OriginOf(*person_, start_, "left_palm") + Eigen::Vector3d(0.3, 0.3, 0.3);
  std::vector<Goal> goals = Planted();
  goals.push_back(GoalOf(PositionGoal{"left_palm", hand, {}}, 1, 1));
  goals.push_back(GoalOf(PostureGoal{NeutralPositions(*person_), {}}, 1, 2));
  for (double most : {0.01, 0.05}) {
    SolverOptions options;
    options.max_step = most;
    Eigen::VectorXd q = start_;
    double distance = (OriginOf(*person_, q, "left_palm") - hand).norm();
    for (int frame = 0; frame < 5; ++frame) {
      const Eigen::VectorXd before = q;
      q = SolveGoals(person_, goals, before, options).positions;
      Eigen::VectorXd change(person_->velocity_count());
      Difference(*person_, before, q, change);
      EXPECT_LE(change.cwiseAbs().maxCoeff(), most + 1e-9) << frame;
      ExpectPlanted(q);
      const double left = (OriginOf(*person_, q, "left_palm") - hand).norm();
      EXPECT_LT(left, distance) << frame;
      distance = left;
    }
  }
}

TEST_F(PrioritizedBodyTest, AHalfSpaceAboveStaysAnInequality) {
  const Eigen::Vector3d sole = OriginOf(*person_, start_, "left_sole");
  const auto solve = [&](double target_y) {
    return SolveGoals(
        person_,
        {GoalOf(HalfSpaceGoal{"left_sole", {0, 1, 0}, sole.y()}),
         GoalOf(
             PositionGoal{
                 "left_sole", {sole.x(), target_y, sole.z() + 0.05}, {}},
             1, 1)},
        start_);
  };
  // Asked below it stays on the plane, and is right along it.
  const Solved below = solve(sole.y() - 0.1);
  const Eigen::Vector3d on = OriginOf(*person_, below.positions, "left_sole");
  EXPECT_NEAR(on.y(), sole.y(), kDisturbance_m);
  EXPECT_GE(on.y(), sole.y() - kDisturbance_m);
  EXPECT_NEAR(on.x(), sole.x(), 1e-4);
  EXPECT_NEAR(on.z(), sole.z() + 0.05, 1e-4);
  EXPECT_EQ(below.report.outcome, SolveOutcome::kUnreachable);
  EXPECT_NEAR(below.report.position_errors_m[1], 0.1, 1e-4);
  // Asked above it goes there.
  const Solved above = solve(sole.y() + 0.1);
  EXPECT_EQ(above.report.outcome, SolveOutcome::kConverged);
  EXPECT_NEAR(OriginOf(*person_, above.positions, "left_sole").y(),
              sole.y() + 0.1, 1e-4);
}

TEST_F(PrioritizedBodyTest, TheSameRequestGivesTheSameAnswer) {
  std::vector<Goal> goals = Planted();
  goals.push_back(GoalOf(PositionGoal{"left_palm", {2, 2, 0}, {}}, 1, 1));
  for (size_t i = 0; i < goals.size(); ++i) goals[i].id += std::to_string(i);
  const IkProblem problem = IkProblem::Create(person_, goals).value();
  SolverOptions options;
  options.max_restarts = 3;
  IkSolver solver;
  Eigen::VectorXd first;
  for (int round = 0; round < 3; ++round) {
    Eigen::VectorXd q = start_;
    SolveReport report;
    solver.Solve(problem, options, SolveStart::kCold, q, report);
    EXPECT_EQ(report.restart_count, 3);
    if (round == 0) first = q;
    EXPECT_EQ(q, first);
  }
}

TEST_F(PrioritizedBodyTest, StopsWhenToldTo) {
  std::vector<Goal> goals = Planted();
  goals.push_back(GoalOf(PositionGoal{"left_palm", {2, 2, 0}, {}}, 1, 1));
  for (size_t i = 0; i < goals.size(); ++i) goals[i].id += std::to_string(i);
  const IkProblem problem = IkProblem::Create(person_, goals).value();
  int left = 4;
  const StopCondition stop = {
      [](const void* context) {
        return --*static_cast<int*>(const_cast<void*>(context)) <= 0;
      },
      &left};
  PrioritizedSolver solver;
  Eigen::VectorXd q = start_;
  SolveReport report;
  solver.Solve(problem, {}, SolveStart::kWarm, q, report, stop);
  EXPECT_EQ(report.outcome, SolveOutcome::kTimeLimit);
  EXPECT_LE(report.iteration_count, 4);
  ExpectPlanted(q);
}

TEST_F(PrioritizedBodyTest, IterationsAreCountedForEachLevel) {
  std::vector<Goal> goals = Planted();
  goals.push_back(GoalOf(PositionGoal{"left_palm", {2, 2, 0}, {}}, 1, 1));
  goals.push_back(GoalOf(PostureGoal{NeutralPositions(*person_), {}}, 1, 2));
  for (int most : {0, 1, 3}) {
    SolverOptions options;
    options.max_iterations = most;
    const Solved solved = SolveGoals(person_, goals, start_, options);
    EXPECT_LE(solved.report.iteration_count, 3 * most);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kIterationLimit);
    ExpectPlanted(solved.positions);
  }
}

TEST_F(PrioritizedBodyTest, TheReportIsWhole) {
  std::vector<Goal> goals = Planted();
  goals.push_back(GoalOf(PositionGoal{"left_palm", {3, 2, 0}, {}}, 1, 1));
  SolverOptions options;
  options.detail = ReportDetail::kDiagnosis;
  options.max_iterations = 200;
  const Solved solved = SolveGoals(person_, goals, start_, options);
  const SolveReport& report = solved.report;
  EXPECT_EQ(report.method, SolverMethod::kLevenbergMarquardt);
  ASSERT_EQ(report.position_errors_m.size(), 3);
  EXPECT_LT(report.position_errors_m[0], kDisturbance_m);
  EXPECT_LT(report.rotation_errors_rad[1], kDisturbance_m);
  EXPECT_NEAR(report.position_errors_m[2],
              (OriginOf(*person_, solved.positions, "left_palm") -
               Eigen::Vector3d(3, 2, 0))
                  .norm(),
              1e-9);
  EXPECT_GT(report.change, 0.1);
  EXPECT_GE(report.rank, 12);
  EXPECT_LE(report.rank, 15);
  EXPECT_EQ(report.free_velocity_count,
            person_->velocity_count() - report.rank);
}

// A leg that stretches for what it cannot reach ends with its knee at its
// limit, under a level that holds something else.
TEST(PrioritizedGoalsTest, LimitedJointsAreNamed) {
  const auto leg = Leg(true);
  const Solved solved =
      SolveGoals(leg,
                 {GoalOf(HalfSpaceGoal{"sole", {0, 1, 0}, -3}),
                  GoalOf(PositionGoal{"sole", {0, -2, 0}, {}}, 1, 1)},
                 HingedLegAt(0.4, 0.8));
  EXPECT_NE(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_NEAR(solved.report.position_errors_m[1], 2 - 0.95, 1e-4);
  EXPECT_EQ(solved.report.limited_joints, std::vector<int>{1});
}

// Any kind above any other, on any tree: the one above is where it would be
// alone.
TEST(PrioritizedGoalsTest, EveryKindAboveEveryOther) {
  Random random(12);
  int pairs = 0;
  int reached = 0;
  for (int trial = 0; trial < 4 * kGoalKindCount * kGoalKindCount; ++trial) {
    SkeletonRecipe recipe;
    recipe.joint_count = 8 + trial % 7;
    const auto skeleton = RandomSkeleton(random, recipe);
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *skeleton);
    const Eigen::VectorXd start = StartNear(random, *skeleton, truth, 0.2);
    const auto high =
        RandomGoal(random, *skeleton, trial % kGoalKindCount, truth);
    const auto low =
        RandomGoal(random, *skeleton, trial / kGoalKindCount % kGoalKindCount,
                   RandomPose(random, *skeleton));
    if (!high || !low) continue;
    ++pairs;
    const Goal off = GoalOf(PostureGoal{start, {}}, 0, 7);
    const Solved alone =
        SolveGoals(skeleton, {GoalOf(*high, 1, 2), off}, start);
    const Solved both =
        SolveGoals(skeleton, {GoalOf(*high, 1, 2), GoalOf(*low, 1, 5)}, start);
    EXPECT_LE(both.report.position_errors_m[0],
              alone.report.position_errors_m[0] + kDisturbance_m)
        << GoalKindName(*high) << " " << GoalKindName(*low);
    EXPECT_LE(both.report.rotation_errors_rad[0],
              alone.report.rotation_errors_rad[0] + kDisturbance_m)
        << GoalKindName(*high) << " " << GoalKindName(*low);
    EXPECT_LE(LimitExcess(*skeleton, both.positions, nullptr), kOnLimit);
    if (alone.report.outcome == SolveOutcome::kConverged) ++reached;
  }
  EXPECT_GT(pairs, 150);
  EXPECT_GT(reached, pairs / 2);
}

}  // namespace
}  // namespace gelenk
