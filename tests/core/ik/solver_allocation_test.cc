// A warm solve takes no memory.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "gelenk/ik/batch_solver.h"
#include "gelenk/ik/fabrik_solver.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/ik/prioritized_solver.h"
#include "gelenk/kinematics/jacobian.h"
#include "gelenk/kinematics/kinematic_tree.h"
#include "tests/testing/allocation_count.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::AllocationCount;
using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::PandaArm;
using ::gelenk::testing::PoseGoalsAt;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::StartNear;

// A stream: targets along the way between two poses, some out of reach.
struct Stream {
  IkProblem problem;
  std::vector<std::vector<GoalTarget>> frames;
  Eigen::VectorXd positions;
  SolveReport report;
};

Stream MakeStream(Random& random,
                  const std::shared_ptr<const Skeleton>& skeleton) {
  const Eigen::VectorXd start = RandomPoseWithinLimits(random, *skeleton);
  Stream stream = {
      IkProblem::Create(skeleton, PoseGoalsAt(*skeleton, start)).value(),
      {},
      start,
      {}};
  for (int frame = 0; frame < 20; ++frame) {
    const Eigen::VectorXd pose = frame % 4 == 3
                                     ? RandomPose(random, *skeleton)
                                     : StartNear(random, *skeleton, start, 0.2);
    stream.frames.emplace_back();
    for (const Goal& goal : PoseGoalsAt(*skeleton, pose)) {
      stream.frames.back().push_back(TargetOf(goal.kind));
    }
  }
  return stream;
}

void SolveFrame(LevenbergMarquardtSolver& solver, Stream& stream, int frame,
                const SolverOptions& options) {
  std::vector<GoalTarget>& targets = stream.frames[frame];
  for (size_t i = 0; i < targets.size(); ++i) {
    const int goal = static_cast<int>(i);
    ASSERT_TRUE(stream.problem.CheckTarget(goal, targets[i]).ok());
    stream.problem.SetTarget(goal, targets[i]);
  }
  solver.Solve(stream.problem, options, SolveStart::kWarm, stream.positions,
               stream.report);
}

int AllocationsOfWarmFrames(std::vector<Stream>& streams,
                            const SolverOptions& options) {
  LevenbergMarquardtSolver solver;
  for (Stream& stream : streams) SolveFrame(solver, stream, 0, options);
  const int before = AllocationCount();
  for (int frame = 1; frame < 20; ++frame) {
    for (Stream& stream : streams) SolveFrame(solver, stream, frame, options);
  }
  return AllocationCount() - before;
}

TEST(SolverAllocationTest, TheCounterCounts) {
  const int before = AllocationCount();
  const auto number = std::make_unique<int>(7);
  const int after_new = AllocationCount();
  const Eigen::VectorXd vector = Eigen::VectorXd::Constant(100, *number);
  EXPECT_EQ(after_new - before, 1);
  EXPECT_EQ(AllocationCount() - after_new, vector.sum() == 700 ? 1 : 0);
}

TEST(SolverAllocationTest, WarmFramesOfAnArm) {
  Random random(1);
  std::vector<Stream> streams;
  streams.push_back(MakeStream(random, PandaArm()));
  EXPECT_EQ(AllocationsOfWarmFrames(streams, {}), 0);
}

TEST(SolverAllocationTest, WarmFramesWithRestarts) {
  Random random(2);
  SolverOptions options;
  options.max_restarts = 3;
  std::vector<Stream> streams;
  streams.push_back(MakeStream(random, PandaArm()));
  // The first frame may have needed none.
  LevenbergMarquardtSolver solver;
  for (int frame = 0; frame < 4; ++frame) {
    SolveFrame(solver, streams[0], frame, options);
  }
  const int before = AllocationCount();
  for (int frame = 4; frame < 20; ++frame) {
    SolveFrame(solver, streams[0], frame, options);
  }
  EXPECT_EQ(AllocationCount() - before, 0);
}

// One thread serves many sessions in turn.
TEST(SolverAllocationTest, WarmFramesOfManySkeletonsInTurn) {
  Random random(3);
  std::vector<Stream> streams;
  for (int i = 0; i < 8; ++i) {
    streams.push_back(MakeStream(random, RandomSkeleton(random)));
  }
  streams.push_back(MakeStream(random, PandaArm()));
  EXPECT_EQ(AllocationsOfWarmFrames(streams, {}), 0);
}

TEST(SolverAllocationTest, ABatchOfArmsTheSecondTime) {
  Random random(7);
  const auto panda = PandaArm();
  const Eigen::VectorXd start = RandomPoseWithinLimits(random, *panda);
  IkProblem problem =
      IkProblem::Create(panda, PoseGoalsAt(*panda, start)).value();
  std::vector<GoalTarget> targets;
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd pose = RandomPose(random, *panda);
    targets.push_back(TargetOf(PoseGoalsAt(*panda, pose)[0].kind));
  }
  BatchSolver solver;
  BatchReport report;
  Eigen::MatrixXd positions = start.replicate(1, 200);
  solver.Solve(problem, targets, {}, SolveStart::kCold, positions, report);
  positions.colwise() = start;
  const int before = AllocationCount();
  solver.Solve(problem, targets, {}, SolveStart::kCold, positions, report);
  EXPECT_EQ(AllocationCount() - before, 0);
}

// Levels of priority on several skeletons in turn, some targets out of reach.
TEST(SolverAllocationTest, WarmFramesOfLevels) {
  Random random(9);
  struct Actor {
    IkProblem problem;
    std::vector<Eigen::Vector3d> targets;
    Eigen::VectorXd positions;
  };
  std::vector<Actor> actors;
  for (int i = 0; i < 4; ++i) {
    const auto skeleton = RandomSkeleton(random);
    const Eigen::VectorXd start = RandomPoseWithinLimits(random, *skeleton);
    std::vector<Goal> goals = PoseGoalsAt(*skeleton, start);
    const std::string tip = skeleton->end_effectors()[0].id;
    goals.push_back({"com", 1, CenterOfMassGoal{}, 1});
    goals.push_back({"side", 1, HalfSpaceGoal{tip, {0, 1, 0}, 0}, 1});
    goals.push_back({"posture", 1, PostureGoal{start, {}}, 2});
    actors.push_back(
        {IkProblem::Create(skeleton, std::move(goals)).value(), {}, start});
    for (int frame = 0; frame < 10; ++frame) {
      actors.back().targets.push_back(RandomPose(random, *skeleton).head(3));
    }
  }
  PrioritizedSolver solver;
  SolveReport report;
  const auto solve_all = [&](int frame) {
    for (Actor& actor : actors) {
      const int com = static_cast<int>(actor.problem.goals().size()) - 3;
      actor.problem.SetTarget(com, actor.targets[frame]);
      solver.Solve(actor.problem, {}, SolveStart::kWarm, actor.positions,
                   report);
    }
  };
  solve_all(0);
  const int before = AllocationCount();
  for (int frame = 1; frame < 10; ++frame) solve_all(frame);
  EXPECT_EQ(AllocationCount() - before, 0);
}

// A chain with one position goal has a kernel of its own.
TEST(SolverAllocationTest, WarmFramesOfAChain) {
  Random random(6);
  SkeletonRecipe recipe;
  recipe.types = {JointType::kRevolute, JointType::kSpherical};
  recipe.branching = 0;
  recipe.mimicking = 0;
  recipe.joint_count = 40;
  const auto skeleton = RandomSkeleton(random, recipe);
  const std::string id = skeleton->end_effectors()[0].id;
  const auto target_at = [&](const Eigen::VectorXd& pose) {
    return EffectorPose(*skeleton, pose, id).translation;
  };
  const Eigen::VectorXd start = RandomPoseWithinLimits(random, *skeleton);
  std::vector<Stream> streams;
  streams.push_back(
      {IkProblem::Create(skeleton, {PositionGoalFor(id, target_at(start))})
           .value(),
       {},
       start,
       {}});
  for (int frame = 0; frame < 20; ++frame) {
    streams[0].frames.push_back(
        {target_at(StartNear(random, *skeleton, start, 0.2))});
  }
  EXPECT_EQ(AllocationsOfWarmFrames(streams, {}), 0);
}

TEST(SolverAllocationTest, FabrikOnceItHasSeenTheChain) {
  Random random(7);
  SkeletonRecipe recipe;
  recipe.types = {JointType::kSpherical};
  recipe.branching = 0;
  recipe.limited = 0;
  recipe.joint_count = 30;
  const auto skeleton = RandomSkeleton(random, recipe);
  const std::string id = skeleton->end_effectors()[0].id;
  const Eigen::VectorXd truth = RandomPose(random, *skeleton);
  const IkProblem problem =
      IkProblem::Create(
          skeleton,
          {PositionGoalFor(id, EffectorPose(*skeleton, truth, id).translation)})
          .value();
  ASSERT_TRUE(FabrikSolver::Check(problem).ok());
  const Eigen::VectorXd start = RandomPose(random, *skeleton);
  Eigen::VectorXd positions = start;
  FabrikSolver solver;
  SolveReport report;
  solver.Solve(problem, {}, positions, report);
  positions = start;
  const int before = AllocationCount();
  solver.Solve(problem, {}, positions, report);
  EXPECT_EQ(AllocationCount() - before, 0);
}

TEST(SolverAllocationTest, ForwardKinematicsAndJacobian) {
  Random random(4);
  const auto skeleton = RandomSkeleton(random);
  const EffectorFrame effector =
      *skeleton->FindEffector(skeleton->end_effectors()[0].id);
  const Eigen::VectorXd pose = RandomPose(random, *skeleton);
  WorldTransforms frames;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;
  ForwardKinematics(*skeleton, pose, frames);
  ComputeJacobian(*skeleton, pose, frames, effector, jacobian);
  const int before = AllocationCount();
  ForwardKinematics(*skeleton, pose, frames);
  ComputeJacobian(*skeleton, pose, frames, effector, jacobian);
  EXPECT_EQ(AllocationCount() - before, 0);
}

TEST(SolverAllocationTest, KinematicTree) {
  Random random(5);
  const auto skeleton = RandomSkeleton(random);
  const Eigen::VectorXd pose = RandomPose(random, *skeleton);
  const KinematicTree tree(*skeleton);
  KinematicFrames frames;
  tree.Evaluate(pose, frames);
  const int before = AllocationCount();
  tree.Evaluate(pose, frames);
  EXPECT_EQ(AllocationCount() - before, 0);
}

}  // namespace
}  // namespace gelenk
