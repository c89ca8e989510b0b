// A batch answers each target as a solve of its own would, whatever its
// neighbours are, on every level of the instruction set.
#include "gelenk/ik/batch_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/ik/solve_arm.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::OraclePositionError;
using ::gelenk::testing::OracleRotationError;
using ::gelenk::testing::PandaArm;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::PoseGoalFor;
using ::gelenk::testing::PoseGoalsAt;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RotationGoalFor;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::StartNear;
using ::gelenk::testing::Ur5Arm;

constexpr double kRounding = 1e-9;
constexpr double kWarmDistance = 0.1;

struct Batch {
  std::shared_ptr<const Skeleton> skeleton;
  std::vector<Goal> goals;
  std::vector<GoalTarget> targets;
  Eigen::MatrixXd starts;
};

// Targets that random poses meet, but for every `far_every`-th, from starts
// nearby.
Batch MakeBatch(Random& random, const std::shared_ptr<const Skeleton>& skeleton,
                int count, int far_every) {
  Batch batch = {skeleton, {}, {}, {}};
  batch.starts.resize(skeleton->position_count(), count);
  for (int c = 0; c < count; ++c) {
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *skeleton);
    batch.goals = PoseGoalsAt(*skeleton, truth);
    for (const Goal& goal : batch.goals) {
      GoalTarget target = TargetOf(goal.kind);
      if (c % far_every == far_every - 1) {
        std::get<RigidTransform>(target).translation *= 4;
      }
      batch.targets.push_back(target);
    }
    batch.starts.col(c) = StartNear(random, *skeleton, truth, kWarmDistance);
  }
  return batch;
}

struct Solved {
  Eigen::MatrixXd positions;
  BatchReport report;
};

class BatchTest : public ::testing::TestWithParam<InstructionSet> {
 protected:
  Solved Solve(const Batch& batch, SolveStart from,
               const SolverOptions& options = {},
               const StopCondition& stop = {}) {
    IkProblem problem = IkProblem::Create(batch.skeleton, batch.goals).value();
    Solved solved;
    solved.positions = batch.starts;
    solver_.Solve(problem, batch.targets, options, from, solved.positions,
                  solved.report, stop);
    return solved;
  }

  // Column by column as the solver of one answers.
  Solved SolveOneByOne(const Batch& batch, SolveStart from,
                       const SolverOptions& options = {}) {
    IkProblem problem = IkProblem::Create(batch.skeleton, batch.goals).value();
    LevenbergMarquardtSolver solver(GetParam());
    const size_t goals = batch.goals.size();
    Solved solved;
    solved.positions = batch.starts;
    for (int c = 0; c < batch.starts.cols(); ++c) {
      for (size_t g = 0; g < goals; ++g) {
        problem.SetTarget(static_cast<int>(g), batch.targets[c * goals + g]);
      }
      SolveReport report;
      solver.Solve(problem, options, from, solved.positions.col(c), report);
      solved.report.outcomes.push_back(report.outcome);
      solved.report.restart_counts.push_back(report.restart_count);
      solved.report.position_errors_m.push_back(report.position_errors_m[0]);
    }
    return solved;
  }

  void ExpectHonest(const Batch& batch, const Solved& solved,
                    const SolverOptions& options) {
    const size_t goals = batch.goals.size();
    for (int c = 0; c < batch.starts.cols(); ++c) {
      const Eigen::VectorXd positions = solved.positions.col(c);
      EXPECT_LE(LimitExcess(*batch.skeleton, positions, nullptr), kRounding);
      for (size_t g = 0; g < goals; ++g) {
        Goal goal = batch.goals[g];
        Retarget(goal.kind, batch.targets[c * goals + g]);
        const double position =
            OraclePositionError(*batch.skeleton, goal, positions);
        const double rotation =
            OracleRotationError(*batch.skeleton, goal, positions);
        const size_t at = c * goals + g;
        EXPECT_NEAR(solved.report.position_errors_m[at], position, kRounding);
        EXPECT_NEAR(solved.report.rotation_errors_rad[at], rotation, 1e-7);
        if (solved.report.outcomes[c] != SolveOutcome::kConverged) continue;
        EXPECT_LE(position, options.position_tolerance_m + kRounding);
        EXPECT_LE(rotation, options.rotation_tolerance_rad + kRounding);
      }
    }
  }

  BatchSolver solver_{GetParam()};
};

TEST_P(BatchTest, WarmAnswersAreAsGoodAsOfOneByOne) {
  Random random(1);
  for (const auto& arm : {PandaArm(), Ur5Arm()}) {
    // More than a block of them.
    const Batch batch = MakeBatch(random, arm, 1500, 50);
    SolverOptions options;
    options.position_tolerance_m = 1e-5;
    options.rotation_tolerance_rad = 1e-5;
    const Solved solved = Solve(batch, SolveStart::kWarm, options);
    const Solved alone = SolveOneByOne(batch, SolveStart::kWarm, options);
    ExpectHonest(batch, solved, options);
    EXPECT_EQ(solved.report.outcomes, alone.report.outcomes);
    for (int c = 0; c < batch.starts.cols(); ++c) {
      EXPECT_EQ(solved.report.restart_counts[c], 0);
      const Eigen::VectorXd positions = solved.positions.col(c);
      if (solved.report.outcomes[c] != SolveOutcome::kConverged) {
        EXPECT_EQ(positions, alone.positions.col(c));
      } else if (c % 50 != 49) {
        EXPECT_LE((positions - batch.starts.col(c)).cwiseAbs().maxCoeff(),
                  kArmJump);
      }
    }
  }
}

TEST_P(BatchTest, ColdAnswersAreAsGoodAsOfOneByOne) {
  Random random(2);
  Batch batch = MakeBatch(random, PandaArm(), 300, 60);
  const PositionBounds& bounds = batch.skeleton->position_bounds();
  batch.starts.colwise() = 0.5 * (bounds.lower + bounds.upper);
  const Solved solved = Solve(batch, SolveStart::kCold);
  const Solved alone = SolveOneByOne(batch, SolveStart::kCold);
  ExpectHonest(batch, solved, {});
  int converged = 0;
  int restarted = 0;
  for (int c = 0; c < batch.starts.cols(); ++c) {
    const bool there = solved.report.outcomes[c] == SolveOutcome::kConverged;
    EXPECT_EQ(there, alone.report.outcomes[c] == SolveOutcome::kConverged);
    converged += there;
    restarted += there && solved.report.restart_counts[c] > 0;
    EXPECT_EQ(solved.report.restart_counts[c] > 0,
              alone.report.restart_counts[c] > 0);
  }
  EXPECT_EQ(converged, 295);
  EXPECT_GT(restarted, 20);
}

TEST_P(BatchTest, AnAnswerDoesNotDependOnItsNeighbours) {
  Random random(3);
  SkeletonRecipe recipe;
  recipe.types = {JointType::kRevolute, JointType::kPrismatic};
  recipe.joint_count = 7;
  recipe.branching = 0;
  recipe.mimicking = 0;
  // Free slides restart near their start.
  recipe.limited = 0.5;
  for (int i = 0; i < 4; ++i) {
    const auto arm = i == 0 ? PandaArm() : RandomSkeleton(random, recipe);
    const Batch batch = MakeBatch(random, arm, 60, 7);
    for (SolveStart from : {SolveStart::kWarm, SolveStart::kCold}) {
      const Solved all = Solve(batch, from);
      // The last first, and without every third.
      Batch other = {batch.skeleton, batch.goals, {}, {}};
      std::vector<int> columns;
      for (int c = static_cast<int>(batch.starts.cols()) - 1; c >= 0; --c) {
        if (c % 3 != 0) columns.push_back(c);
      }
      other.starts.resize(batch.starts.rows(), columns.size());
      for (size_t k = 0; k < columns.size(); ++k) {
        other.targets.push_back(batch.targets[columns[k]]);
        other.starts.col(k) = batch.starts.col(columns[k]);
      }
      const Solved some = Solve(other, from);
      for (size_t k = 0; k < columns.size(); ++k) {
        EXPECT_EQ(some.positions.col(k), all.positions.col(columns[k]));
        EXPECT_EQ(some.report.outcomes[k], all.report.outcomes[columns[k]]);
        EXPECT_EQ(some.report.iteration_counts[k],
                  all.report.iteration_counts[columns[k]]);
      }
    }
  }
}

TEST_P(BatchTest, TreesWithManyGoalsAreSolvedOneByOne) {
  Random random(4);
  const auto tree = RandomSkeleton(random);
  const Batch batch = MakeBatch(random, tree, 40, 40);
  ASSERT_GT(batch.goals.size(), 1u);
  const Solved solved = Solve(batch, SolveStart::kWarm);
  const Solved alone = SolveOneByOne(batch, SolveStart::kWarm);
  EXPECT_EQ(solved.positions, alone.positions);
  EXPECT_EQ(solved.report.outcomes, alone.report.outcomes);
  ExpectHonest(batch, solved, {});
}

TEST_P(BatchTest, PointsAndOrientationsAreTargetsToo) {
  Random random(5);
  const auto panda = PandaArm();
  Batch points = MakeBatch(random, panda, 100, 1000);
  Batch turns = points;
  points.goals = {PositionGoalFor("tip", Eigen::Vector3d::Zero())};
  turns.goals = {RotationGoalFor("tip", Eigen::Quaterniond::Identity())};
  for (int c = 0; c < 100; ++c) {
    const RigidTransform pose = std::get<RigidTransform>(points.targets[c]);
    points.targets[c] = pose.translation;
    turns.targets[c] = pose.rotation;
  }
  for (const Batch& batch : {points, turns}) {
    const Solved solved = Solve(batch, SolveStart::kWarm);
    ExpectHonest(batch, solved, {});
    EXPECT_THAT(solved.report.outcomes,
                ::testing::Each(SolveOutcome::kConverged));
  }
}

TEST_P(BatchTest, StartsOutsideTheLimitsAreMovedInside) {
  Random random(6);
  Batch batch = MakeBatch(random, PandaArm(), 20, 1000);
  batch.starts.row(0).setConstant(50);
  const Solved solved = Solve(batch, SolveStart::kWarm);
  ExpectHonest(batch, solved, {});
}

TEST_P(BatchTest, StartsOfManyTurnsAreTaken) {
  Batch batch = {PlanarChain({0, 0, 0}, {1, 1}),
                 {PositionGoalFor("tip", Eigen::Vector3d::Zero())},
                 {},
                 {}};
  batch.starts.resize(2, 3);
  for (int c = 0; c < 3; ++c) {
    batch.targets.push_back(Eigen::Vector3d(1, 1, 0));
    batch.starts.col(c) = Eigen::Vector2d(c == 1 ? 2e5 : 0.3, 0.9);
  }
  const Solved solved = Solve(batch, SolveStart::kWarm);
  EXPECT_THAT(solved.report.outcomes,
              ::testing::Each(SolveOutcome::kConverged));
}

TEST_P(BatchTest, AnEmptyBatchIsFine) {
  Batch batch = {PandaArm(), {PoseGoalFor("tip", {})}, {}, {}};
  batch.starts.resize(7, 0);
  EXPECT_TRUE(Solve(batch, SolveStart::kCold).report.outcomes.empty());
}

TEST_P(BatchTest, StopsWhenToldTo) {
  Random random(7);
  const Batch batch = MakeBatch(random, PandaArm(), 50, 1000);
  int asked = 0;
  const auto after_two = [](const void* context) {
    int& count = *const_cast<int*>(static_cast<const int*>(context));
    return ++count > 2;
  };
  const Solved solved =
      Solve(batch, SolveStart::kCold, {}, {after_two, &asked});
  EXPECT_THAT(solved.report.outcomes,
              ::testing::Contains(SolveOutcome::kTimeLimit));
  ExpectHonest(batch, solved, {});
}

INSTANTIATE_TEST_SUITE_P(
    EachLevel, BatchTest, ::testing::ValuesIn(SupportedInstructionSets()),
    [](const ::testing::TestParamInfo<InstructionSet>& info) {
      return std::string(InstructionSetName(info.param));
    });

}  // namespace
}  // namespace gelenk
