#include "server/session/shared_trees.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "tests/testing/example_sessions.h"
#include "tests/testing/example_skeletons.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::ArmGoals;
using ::gelenk::testing::kAim;
using ::gelenk::testing::kReach;
using ::gelenk::testing::PlanarChain;

std::shared_ptr<SharedTrees> ArmTrees() {
  return std::make_shared<SharedTrees>(
      PlanarChain(Eigen::Vector3d::Zero(), {0.5, 0.5, 0.5}));
}

TEST(SharedTreesTest, GoalsAtTheSameEffectorsShareATree) {
  const auto trees = ArmTrees();
  std::vector<Goal> goals = ArmGoals();
  const IkProblem first = trees->CreateProblem(goals).value();
  goals[kReach].id = "another";
  goals[kReach].weight = 5;
  std::get<PositionGoal>(goals[kReach].kind).world_position.x() = 7;
  const IkProblem second = trees->CreateProblem(goals).value();
  EXPECT_EQ(&first.tree(), &second.tree());
  EXPECT_EQ(trees->tree_count(), 1);
}

TEST(SharedTreesTest, GoalsElsewhereDoNot) {
  const auto trees = ArmTrees();
  std::vector<Goal> goals = ArmGoals();
  const IkProblem first = trees->CreateProblem(goals).value();
  std::get<RotationGoal>(goals[kAim].kind).end_effector_id = "j2";
  const IkProblem second = trees->CreateProblem(goals).value();
  EXPECT_NE(&first.tree(), &second.tree());
  goals = ArmGoals();
  goals[kReach].kind = PoseGoal{"tip", {}, 1, {}};
  const IkProblem third = trees->CreateProblem(goals).value();
  EXPECT_NE(&first.tree(), &third.tree()) << "other rows";
  goals = ArmGoals();
  std::swap(goals[kReach], goals[kAim]);
  const IkProblem fourth = trees->CreateProblem(goals).value();
  EXPECT_NE(&first.tree(), &fourth.tree()) << "another order";
  EXPECT_EQ(trees->tree_count(), 4);
}

TEST(SharedTreesTest, ATreeGoesWithItsLastProblem) {
  const auto trees = ArmTrees();
  {
    const IkProblem problem = trees->CreateProblem(ArmGoals()).value();
    EXPECT_EQ(trees->tree_count(), 1);
  }
  EXPECT_EQ(trees->tree_count(), 0);
  EXPECT_TRUE(trees->CreateProblem(ArmGoals()).ok());
}

TEST(SharedTreesTest, AProblemOutlivesThem) {
  auto trees = ArmTrees();
  const IkProblem problem = trees->CreateProblem(ArmGoals()).value();
  trees.reset();
  IkSolver solver;
  SolveReport report;
  Eigen::VectorXd positions = Eigen::Vector3d(0.1, 0.2, 0.3);
  solver.Solve(problem, {}, SolveStart::kWarm, positions, report);
  EXPECT_EQ(report.position_errors_m.size(), 3);
}

TEST(SharedTreesTest, RefusesWhatAProblemRefuses) {
  std::vector<Goal> goals = ArmGoals();
  goals[kReach].weight = -1;
  const auto trees = ArmTrees();
  EXPECT_EQ(trees->CreateProblem(goals).status(),
            IkProblem::Create(trees->skeleton(), goals).status());
}

TEST(SharedTreesTest, ServesThreads) {
  const auto trees = ArmTrees();
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&trees, t] {
      for (int i = 0; i < 100; ++i) {
        std::vector<Goal> goals = ArmGoals();
        if ((i + t) % 3 == 0) goals.pop_back();
        EXPECT_EQ(trees->CreateProblem(goals)->goals().size(), goals.size());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(trees->tree_count(), 0);
}

}  // namespace
}  // namespace gelenk::server
