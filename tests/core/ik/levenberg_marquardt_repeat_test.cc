// The same request has the same answer: bit by bit on one level of the
// instruction set, within rounding across levels.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "tests/core/ik/solve_answer.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::ExpectSameBits;
using ::gelenk::testing::PandaArm;
using ::gelenk::testing::PoseGoalsAt;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::SolveAnswer;
using ::gelenk::testing::StartNear;
using ::gelenk::testing::UniformIndex;

struct Request {
  IkProblem problem;
  SolverOptions options;
  SolveStart from;
  Eigen::VectorXd start;
};

SolveAnswer Ask(LevenbergMarquardtSolver& solver, const Request& request) {
  SolveAnswer answer;
  answer.positions = request.start;
  solver.Solve(request.problem, request.options, request.from, answer.positions,
               answer.report);
  return answer;
}

// Trees of all sizes, warm and cold, within reach and out of it.
std::vector<Request> Requests() {
  Random random(1);
  std::vector<Request> requests;
  SkeletonRecipe recipe;
  for (int i = 0; i < 60; ++i) {
    recipe.joint_count = 1 + UniformIndex(random, 20);
    const auto skeleton = RandomSkeleton(random, recipe);
    const bool reachable = i % 3 != 0;
    const Eigen::VectorXd truth =
        reachable ? RandomPoseWithinLimits(random, *skeleton)
                  : RandomPose(random, *skeleton);
    SolverOptions options;
    options.max_restarts = i % 2 == 0 ? 4 : 0;
    options.restart_seed = i;
    requests.push_back(
        {IkProblem::Create(skeleton, PoseGoalsAt(*skeleton, truth)).value(),
         options, i % 2 == 0 ? SolveStart::kCold : SolveStart::kWarm,
         StartNear(random, *skeleton, truth, 0.5)});
  }
  return requests;
}

TEST(RepeatTest, SameRequestSameBits) {
  const std::vector<Request> requests = Requests();
  LevenbergMarquardtSolver old;
  std::vector<SolveAnswer> first;
  for (const Request& request : requests) first.push_back(Ask(old, request));
  // By then the solver's memory holds traces of all of them.
  for (size_t i = 0; i < requests.size(); ++i) {
    ExpectSameBits(first[i], Ask(old, requests[i]));
    LevenbergMarquardtSolver fresh;
    ExpectSameBits(first[i], Ask(fresh, requests[i]));
  }
}

TEST(RepeatTest, ATargetSetLaterIsAsGoodAsOneGiven) {
  Random random(2);
  const auto panda = PandaArm();
  const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *panda);
  const Eigen::VectorXd other = RandomPoseWithinLimits(random, *panda);
  const std::vector<Goal> goals = PoseGoalsAt(*panda, truth);
  Request given = {
      IkProblem::Create(panda, goals).value(), {}, SolveStart::kCold, other};
  Request set = {IkProblem::Create(panda, PoseGoalsAt(*panda, other)).value(),
                 {},
                 SolveStart::kCold,
                 other};
  set.problem.SetTarget(0, TargetOf(goals[0].kind));
  LevenbergMarquardtSolver solver;
  ExpectSameBits(Ask(solver, given), Ask(solver, set));
}

TEST(RepeatTest, RestartsFollowTheirSeed) {
  Random random(3);
  const auto panda = PandaArm();
  const Eigen::VectorXd start = RandomPoseWithinLimits(random, *panda);
  LevenbergMarquardtSolver solver;
  int restarted = 0;
  int different = 0;
  for (int i = 0; i < 40; ++i) {
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *panda);
    Request request = {
        IkProblem::Create(panda, PoseGoalsAt(*panda, truth)).value(),
        {},
        SolveStart::kCold,
        start};
    request.options.restart_seed = 5;
    const SolveAnswer first = Ask(solver, request);
    ExpectSameBits(first, Ask(solver, request));
    if (first.report.restart_count == 0) continue;
    ++restarted;
    request.options.restart_seed = 6;
    different += Ask(solver, request).positions != first.positions;
  }
  EXPECT_GT(restarted, 5);
  EXPECT_GT(different, 0);
}

TEST(RepeatTest, InstructionSetsAgree) {
  // Warm problems converge quadratically, so that differences of rounding do
  // not grow.
  constexpr double kLevelRounding = 1e-9;
  Random random(4);
  SkeletonRecipe recipe;
  for (int i = 0; i < 100; ++i) {
    recipe.joint_count = 1 + UniformIndex(random, 20);
    const auto skeleton = RandomSkeleton(random, recipe);
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *skeleton);
    const Request request = {
        IkProblem::Create(skeleton, PoseGoalsAt(*skeleton, truth)).value(),
        {},
        SolveStart::kWarm,
        StartNear(random, *skeleton, truth, 0.1)};
    LevenbergMarquardtSolver baseline(InstructionSet::kBaseline);
    const SolveAnswer want = Ask(baseline, request);
    for (InstructionSet level : SupportedInstructionSets()) {
      LevenbergMarquardtSolver solver(level);
      EXPECT_EQ(solver.instruction_set(), level);
      const SolveAnswer got = Ask(solver, request);
      EXPECT_EQ(got.report.outcome, want.report.outcome);
      if (want.positions.size() == 0) continue;
      EXPECT_LE((got.positions - want.positions).cwiseAbs().maxCoeff(),
                kLevelRounding)
          << InstructionSetName(level);
    }
  }
}

}  // namespace
}  // namespace gelenk
