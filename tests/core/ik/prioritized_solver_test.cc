#include "gelenk/ik/prioritized_solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gelenk/ik/ik_solver.h"
#include "tests/core/ik/goals/solve_goals.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::GoalOf;
using ::gelenk::testing::OriginOf;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::PoseGoalsAt;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::Solved;
using ::gelenk::testing::SolveGoals;
using ::gelenk::testing::StartNear;
using ::gelenk::testing::Uniform;

// By how much a lower level may disturb a higher one.
constexpr double kDisturbance_m = 1e-6;
// Clamping leaves rounding.
constexpr double kOnLimit = 1e-9;
constexpr AxisMask kPlane = {true, true, false};

GoalKind At(const std::string& id, double x, double y) {
  return PositionGoal{id, {x, y, 0}, kPlane};
}

double Distance(const Skeleton& skeleton, const Eigen::VectorXd& positions,
                const std::string& id, double x, double y) {
  return (OriginOf(skeleton, positions, id) - Eigen::Vector3d(x, y, 0)).norm();
}

Eigen::VectorXd Bent(int joints) {
  return Eigen::VectorXd::LinSpaced(joints, 0.3, 0.6);
}

TEST(PrioritizedSolverTest, BothAreMetWhereBothCanBe) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1, 1, 1});
  for (bool swapped : {false, true}) {
    const Solved solved =
        SolveGoals(chain,
                   {GoalOf(At("tip", 1.2, 2), 1, swapped ? 1 : 0),
                    GoalOf(At("j2", 1.6, 0.6), 1, swapped ? 0 : 1)},
                   Bent(4));
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
    EXPECT_LT(Distance(*chain, solved.positions, "tip", 1.2, 2), 1e-4);
    EXPECT_LT(Distance(*chain, solved.positions, "j2", 1.6, 0.6), 1e-4);
  }
}

// The oracle: a chain of three unit links whose tip is held has one free
// parameter, the direction of the last link; all poses are listed.
double NearestElbow(double tip_x, double tip_y, double x, double y) {
  double nearest = 1e9;
  constexpr int kSteps = 200000;
  for (int i = 0; i < kSteps; ++i) {
    const double phi = 2 * M_PI * i / kSteps;
    const Eigen::Vector2d wrist(tip_x - std::cos(phi), tip_y - std::sin(phi));
    const double half = 0.5 * wrist.norm();
    if (half > 1) continue;
    const Eigen::Vector2d across =
        Eigen::Vector2d(-wrist.y(), wrist.x()).normalized();
    for (double side : {-1.0, 1.0}) {
      const Eigen::Vector2d elbow =
          0.5 * wrist + side * std::sqrt(1 - half * half) * across;
      nearest = std::min(nearest, (elbow - Eigen::Vector2d(x, y)).norm());
    }
  }
  return nearest;
}

TEST(PrioritizedSolverTest, TheHigherWinsAndTheLowerIsAsNearAsThatLeaves) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1, 1});
  Random random(1);
  int global = 0;
  constexpr int kTrials = 20;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double tip_x = Uniform(random, 0.5, 2), tip_y = Uniform(random, 0, 1);
    const double x = Uniform(random, -2, 2), y = Uniform(random, -2, 2);
    std::vector<Goal> goals = {GoalOf(At("tip", tip_x, tip_y), 1, 0),
                               GoalOf(At("j1", x, y), 1, 1)};
    goals[1].id = "elbow";
    Eigen::VectorXd q = Bent(3);
    SolveReport report;
    IkSolver().Solve(IkProblem::Create(chain, goals).value(), {},
                     SolveStart::kCold, q, report);
    EXPECT_LT(Distance(*chain, q, "tip", tip_x, tip_y), kDisturbance_m);
    const double best = NearestElbow(tip_x, tip_y, x, y);
    const double reached = Distance(*chain, q, "j1", x, y);
    EXPECT_GT(reached, best - 1e-6);
    if (reached < best + 1e-4) ++global;
  }
  EXPECT_GE(global, kTrials - 2);
}

// What the higher level gets to alone is what it gets to with a lower one.
TEST(PrioritizedSolverTest, LowerLevelsDisturbNoHigherOneOnRandomTrees) {
  Random random(3);
  int met = 0;
  int missed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    SkeletonRecipe recipe;
    recipe.joint_count = 4 + trial % 12;
    const auto skeleton = RandomSkeleton(random, recipe);
    const Eigen::VectorXd start = RandomPoseWithinLimits(random, *skeleton);
    // Poses within limits are mostly reachable, others mostly not.
    const Eigen::VectorXd wish = trial % 3 == 0
                                     ? RandomPose(random, *skeleton)
                                     : StartNear(random, *skeleton, start, 0.5);
    std::vector<Goal> goals = PoseGoalsAt(*skeleton, wish);
    for (Goal& goal : goals) goal.priority = 0;
    // Of two levels, else what runs is another solver.
    Goal off = GoalOf(PostureGoal{start, {}}, 0, 7);
    goals.push_back(off);
    const Solved alone = SolveGoals(skeleton, goals, start);
    const Eigen::VectorXd lower_wish = RandomPose(random, *skeleton);
    for (Goal& goal : PoseGoalsAt(*skeleton, lower_wish)) {
      goal.priority = 1;
      goals.push_back(goal);
    }
    goals.push_back(
        GoalOf(PostureGoal{RandomPose(random, *skeleton), {}}, 1, 2));
    const Solved both = SolveGoals(skeleton, goals, start);
    const size_t higher = PoseGoalsAt(*skeleton, wish).size();
    for (size_t g = 0; g < higher; ++g) {
      const double a = alone.report.position_errors_m[g];
      const double b = both.report.position_errors_m[g];
      const bool reached = a <= 1e-4;
      ++(reached ? met : missed);
      EXPECT_LE(b, std::max(a, reached ? 0 : a) + kDisturbance_m)
          << trial << " goal " << g << " alone " << int(alone.report.outcome)
          << " it " << alone.report.iteration_count << " both it "
          << both.report.iteration_count;
    }
    EXPECT_TRUE(both.positions.allFinite());
    EXPECT_LE(LimitExcess(*skeleton, both.positions, nullptr), kOnLimit)
        << trial;
  }
  // Both kinds are there.
  EXPECT_GT(met, 300);
  EXPECT_GT(missed, 50);
}

}  // namespace
}  // namespace gelenk
