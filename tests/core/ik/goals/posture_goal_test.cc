#include "gelenk/ik/goals/posture_goal.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/core/ik/goals/solve_goals.h"
#include "tests/testing/example_bodies.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::GoalOf;
using ::gelenk::testing::PersonWithFingers;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::PoseGoalsAt;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RandomVelocity;
using ::gelenk::testing::Solved;
using ::gelenk::testing::SolveGoals;
using ::gelenk::testing::StartNear;

Goal PostureOf(const Eigen::VectorXd& positions, double weight = 1,
               std::vector<double> joint_weights = {}) {
  return GoalOf(PostureGoal{positions, std::move(joint_weights)}, weight);
}

double Distance(const Skeleton& skeleton, const Eigen::VectorXd& a,
                const Eigen::VectorXd& b) {
  Eigen::VectorXd difference(skeleton.velocity_count());
  Difference(skeleton, a, b, difference);
  return difference.norm();
}

// Alone it is simply taken, limits permitting: also by joints that no goal
// moves.
TEST(PostureGoalTest, AloneItIsTaken) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const auto skeleton = RandomSkeleton(random);
    const Eigen::VectorXd posture = RandomPoseWithinLimits(random, *skeleton);
    const Solved solved = SolveGoals(skeleton, {PostureOf(posture)},
                                     RandomPoseWithinLimits(random, *skeleton));
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
    EXPECT_LE(Distance(*skeleton, solved.positions, posture), 1e-6);
    EXPECT_EQ(solved.report.position_errors_m[0], 0);
    EXPECT_EQ(solved.report.rotation_errors_rad[0], 0);
  }
}

// Goals that are met at the posture lead to it from nearby: every direction
// that they leave free is settled, on all kinds of joints.
TEST(PostureGoalTest, SettlesWhatTheGoalsLeaveFree) {
  Random random(2);
  testing::SkeletonRecipe recipe;
  recipe.limited = 0;
  int settled = 0;
  for (int i = 0; i < 100; ++i) {
    const auto skeleton = RandomSkeleton(random, recipe);
    const Eigen::VectorXd posture = RandomPoseWithinLimits(random, *skeleton);
    std::vector<Goal> goals = PoseGoalsAt(*skeleton, posture);
    goals.push_back(PostureOf(posture, 1e-2));
    const Solved solved =
        SolveGoals(skeleton, goals, StartNear(random, *skeleton, posture, 0.3));
    if (solved.report.outcome != SolveOutcome::kConverged) continue;
    ++settled;
    EXPECT_LE(Distance(*skeleton, solved.positions, posture), 5e-3) << i;
  }
  EXPECT_GE(settled, 97);
}

// Links of 1 m, the tip held at (2, 0): the elbow goes up or down with the
// posture.
TEST(PostureGoalTest, ChoosesAmongTheSolutions) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1, 1});
  for (double side : {1.0, -1.0}) {
    const Solved solved =
        SolveGoals(chain,
                   {PositionGoalFor("tip", {2, 0, 0}),
                    PostureOf(side * Eigen::Vector3d(1, -1, -1), 1e-5)},
                   side * Eigen::Vector3d(0.9, -0.5, -0.9));
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
    EXPECT_GT(side * solved.positions[0], 0.3);
  }
}

// The minimum of the whole weighted sum, found by hand: one angle, a goal's
// arc and a pull.
TEST(PostureGoalTest, SharesByWeight) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1});
  const Solved solved =
      SolveGoals(chain,
                 {PositionGoalFor("tip", {std::cos(0.2), std::sin(0.2), 0}),
                  PostureOf(Eigen::VectorXd::Zero(1), 1)},
                 Eigen::VectorXd::Constant(1, 0.2));
  // |chord|^2 / 2 + q^2 / 2: sin(0.2 - q) = q.
  double q = 0.1;
  for (int i = 0; i < 50; ++i) q = 0.5 * (q + std::sin(0.2 - q));
  EXPECT_NEAR(solved.positions[0], q, 1e-6);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
  EXPECT_NEAR(solved.report.position_errors_m[0], 2 * std::sin(0.1 - q / 2),
              1e-6);
}

TEST(PostureGoalTest, JointWeightsCount) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1, 1});
  const Eigen::Vector3d start(0.5, 0.5, 0.5);
  const Solved solved = SolveGoals(
      chain, {PostureOf(Eigen::Vector3d::Zero(), 1, {1, 0, 2})}, start);
  EXPECT_NEAR(solved.positions[0], 0, 1e-9);
  EXPECT_EQ(solved.positions[1], 0.5);
  EXPECT_NEAR(solved.positions[2], 0, 1e-9);
}

TEST(PostureGoalTest, SeveralMeetInTheMiddle) {
  Joint ball;
  ball.id = "ball";
  ball.type = JointType::kSpherical;
  Joint hinge;
  hinge.id = "hinge";
  hinge.parent_id = "ball";
  hinge.type = JointType::kRevolute;
  const auto skeleton =
      SkeletonBuilder().AddJoint(ball).AddJoint(hinge).Build().value();
  Eigen::VectorXd a(5), b(5);
  a << 0, 0, 0, 1, 0;
  StoreXyzw(ExpRotation({0, 0.8, 0}), b.data());
  b.head<4>() *= -1;  // The same rotation, by its other quaternion.
  b[4] = 0.9;
  for (bool in_tree : {false, true}) {
    std::vector<Goal> goals = {PostureOf(a, 1), PostureOf(b, 2)};
    // A goal without weight puts the joints into the tree.
    if (in_tree) {
      goals.push_back(PositionGoalFor("hinge", {0, 0, 0}));
      goals.back().weight = 0;
    }
    const Solved solved = SolveGoals(skeleton, goals, a);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
    EXPECT_NEAR(solved.positions[4], 0.6, 1e-6);
    const Eigen::Quaterniond got = QuaternionXyzw(solved.positions.data());
    // sin(x / 2) = 2 sin((0.8 - x) / 2).
    double x = 0.5;
    for (int i = 0; i < 100; ++i) {
      x += 0.3 * (2 * std::sin((0.8 - x) / 2) - std::sin(x / 2));
    }
    EXPECT_NEAR(AngleBetween(got, ExpRotation({0, x, 0})), 0, 1e-6);
  }
}

TEST(PostureGoalTest, StopsAtLimits) {
  Joint hinge;
  hinge.id = "hinge";
  hinge.type = JointType::kRevolute;
  hinge.limits.lower = {-0.5};
  hinge.limits.upper = {0.5};
  const auto skeleton = SkeletonBuilder().AddJoint(hinge).Build().value();
  const Solved solved =
      SolveGoals(skeleton, {PostureOf(Eigen::VectorXd::Constant(1, 2))},
                 Eigen::VectorXd::Zero(1));
  EXPECT_EQ(solved.positions[0], 0.5);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
}

// Inside the solver too, on swing cones and twist ranges: the closest pose
// within the limits in the objective's metric.
TEST(PostureGoalTest, PullsAlongLimitsOfBallJoints) {
  const auto person = PersonWithFingers();
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    Eigen::VectorXd posture(person->position_count());
    Integrate(*person, person->rest_positions(),
              RandomVelocity(random, *person, 2.5), posture);
    std::vector<Goal> goals = {PostureOf(posture),
                               PositionGoalFor("left_palm", {0, 0, 0}),
                               PositionGoalFor("crown", {0, 0, 0})};
    goals[1].weight = goals[2].weight = 0;
    const Solved solved = SolveGoals(person, goals, person->rest_positions());
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged) << i;
    EXPECT_LE(LimitExcess(*person, solved.positions, nullptr), 1e-9);
    // No small move inside the limits comes nearer.
    const double reached = Distance(*person, solved.positions, posture);
    for (int k = 0; k < 50; ++k) {
      const Eigen::VectorXd near =
          StartNear(random, *person, solved.positions, 0.02);
      EXPECT_GE(Distance(*person, near, posture), reached - 0.02) << i;
    }
  }
}

TEST(PostureGoalTest, WeightZeroIsOff) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1, 1});
  const Eigen::Vector3d start(0.5, 0.5, 0.5);
  const Solved solved =
      SolveGoals(chain, {PostureOf(Eigen::Vector3d::Zero(), 0)}, start);
  EXPECT_EQ(solved.positions, start);
}

// A stream: a frame costs about as much as without, and ends converged.
TEST(PostureGoalTest, AStreamIsCheap) {
  const auto person = PersonWithFingers();
  Random random(5);
  // Bent, so that there is reach left.
  const Eigen::VectorXd rest =
      StartNear(random, *person, person->rest_positions(), 0.5);
  const Eigen::VectorXd way = RandomVelocity(random, *person, 0.1);
  std::vector<Goal> goals = PoseGoalsAt(*person, rest);
  goals.push_back(PostureOf(rest, 1e-6));
  goals.back().id = "posture";
  IkProblem problem = IkProblem::Create(person, goals).value();
  LevenbergMarquardtSolver solver;
  Eigen::VectorXd q = rest;
  SolveReport report;
  int iterations = 0;
  int converged = 0;
  constexpr int kFrames = 200;
  for (int frame = 0; frame < kFrames; ++frame) {
    // Poses that the body had on a way through its joints' ranges.
    Eigen::VectorXd truth(q.size());
    Integrate(*person, rest, std::sin(0.05 * frame) * way, truth);
    ClampToLimits(*person, truth);
    const std::vector<Goal> now = PoseGoalsAt(*person, truth);
    for (size_t g = 0; g < now.size(); ++g) {
      problem.SetTarget(static_cast<int>(g), TargetOf(now[g].kind));
    }
    solver.Solve(problem, {}, SolveStart::kWarm, q, report);
    iterations += report.iteration_count;
    converged += report.outcome == SolveOutcome::kConverged;
  }
  EXPECT_EQ(converged, kFrames);
  EXPECT_LE(iterations, 3 * kFrames);
}

TEST(PostureGoalTest, TargetsAreCheckedAndReplaced) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1, 1});
  IkProblem problem =
      IkProblem::Create(chain, {PostureOf(Eigen::Vector3d::Zero())}).value();
  GoalTarget small = Eigen::VectorXd(Eigen::Vector2d(1, 2));
  EXPECT_FALSE(problem.CheckTarget(0, small).ok());
  GoalTarget target = Eigen::VectorXd(Eigen::Vector3d(0.1, 0.2, 0.3));
  ASSERT_TRUE(problem.CheckTarget(0, target).ok());
  problem.SetTarget(0, target);
  Eigen::VectorXd q = Eigen::Vector3d::Zero();
  SolveReport report;
  LevenbergMarquardtSolver().Solve(problem, {}, SolveStart::kWarm, q, report);
  EXPECT_TRUE(q.isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
}

}  // namespace
}  // namespace gelenk
