// An answer depends on nothing that its solver has done before, nor on what the
// stack held: a solver that has been through many problems and a fresh one give
// the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/ik/batch_solver.h"
#include "gelenk/ik/ik_solver.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/core/ik/solve_answer.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_goals.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::ExpectSameBits;
using ::gelenk::testing::kGoalKindCount;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomDirection;
using ::gelenk::testing::RandomGoal;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeletonBuilder;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::SolveAnswer;
using ::gelenk::testing::StartNear;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::UniformIndex;
using ::gelenk::testing::WithProbability;

constexpr int kProblems = 400;

// Leaves numbers where the next call has its locals.
__attribute__((noinline)) void LitterStack(double number) {
  volatile double litter[4096];
  for (volatile double& place : litter) place = number;
}

struct Request {
  IkProblem problem;
  SolverOptions options;
  SolveStart from;
  Eigen::VectorXd start;
  std::optional<StepBounds> bounds;
};

// Arms, chains of ball joints, and trees of anything.
std::shared_ptr<const Skeleton> AnySkeleton(Random& random) {
  SkeletonRecipe recipe;
  recipe.joint_count = 1 + UniformIndex(random, 20);
  const int shape = UniformIndex(random, 4);
  if (shape < 3) {
    recipe.branching = 0;
    recipe.mimicking = WithProbability(random, 0.3) ? 0.2 : 0;
    recipe.joint_count = 1 + UniformIndex(random, 18);
    recipe.types = {JointType::kRevolute};
    if (shape == 1) recipe.types.push_back(JointType::kPrismatic);
    if (shape == 2) recipe.types = {JointType::kSpherical};
  }
  const auto unlike = RandomSkeletonBuilder(random, recipe).Build().value();
  // The same with stiffnesses of all sizes.
  SkeletonBuilder builder;
  const bool stiff = WithProbability(random, 0.5);
  for (Joint joint : unlike->joints()) {
    for (int k = 0; stiff && k < VelocityCount(joint.type); ++k) {
      joint.stiffness.push_back(std::pow(10, Uniform(random, -6, 3)));
    }
    if (joint.mimic) joint.stiffness.clear();
    builder.AddJoint(std::move(joint));
  }
  for (const EndEffector& effector : unlike->end_effectors()) {
    builder.AddEndEffector(effector);
  }
  return builder.Build().value();
}

std::vector<Goal> AnyGoals(Random& random, const Skeleton& skeleton,
                           const Eigen::VectorXd& truth) {
  std::vector<Goal> goals;
  // One goal at the tip is what arms and chains are solved for.
  const bool alone = WithProbability(random, 0.5);
  const int count = alone ? 1 : 1 + UniformIndex(random, 5);
  const bool levels = WithProbability(random, 0.4);
  for (int g = 0; g < count; ++g) {
    const int kind = alone ? UniformIndex(random, 3)
                           : UniformIndex(random, kGoalKindCount + 2);
    Goal goal;
    goal.id = absl::StrCat("g", g);
    if (kind == kGoalKindCount) {
      goal.kind = PostureGoal{truth, {}};
    } else if (kind == kGoalKindCount + 1) {
      goal.kind = gelenk::PlantGoal{skeleton.joint(0).id, 1};
    } else {
      std::optional<GoalKind> drawn = RandomGoal(random, skeleton, kind, truth);
      if (!drawn) continue;
      goal.kind = *std::move(drawn);
    }
    goal.weight = WithProbability(random, 0.1) ? 0 : Uniform(random, 0.1, 3);
    if (levels) goal.priority = UniformIndex(random, 4);
    goals.push_back(std::move(goal));
  }
  return goals;
}

Request AnyRequest(Random& random) {
  const std::shared_ptr<const Skeleton> skeleton = AnySkeleton(random);
  const Eigen::VectorXd truth = WithProbability(random, 0.7)
                                    ? RandomPoseWithinLimits(random, *skeleton)
                                    : RandomPose(random, *skeleton);
  Request request = {
      IkProblem::Create(skeleton, AnyGoals(random, *skeleton, truth)).value(),
      {},
      WithProbability(random, 0.5) ? SolveStart::kCold : SolveStart::kWarm,
      StartNear(random, *skeleton, truth, 0.7),
      std::nullopt};
  // Far out of reach, or on another spot.
  for (size_t g = 0; g < request.problem.goals().size(); ++g) {
    GoalTarget target = TargetOf(request.problem.goals()[g].kind);
    auto* point = std::get_if<Eigen::Vector3d>(&target);
    if (auto* pose = std::get_if<RigidTransform>(&target)) {
      point = &pose->translation;
    }
    if (point == nullptr || WithProbability(random, 0.7)) continue;
    *point += Uniform(random, 0, 10) * RandomDirection(random);
    request.problem.SetTarget(static_cast<int>(g), target);
  }
  RigidTransform place;
  place.translation = RandomDirection(random);
  request.problem.SetWorldFromSkeleton(place);
  request.options.max_iterations = 1 + UniformIndex(random, 40);
  request.options.max_restarts = UniformIndex(random, 4);
  request.options.restart_seed = UniformIndex(random, 100);
  request.options.detail = static_cast<ReportDetail>(UniformIndex(random, 3));
  if (WithProbability(random, 0.3)) {
    request.options.max_step = Uniform(random, 0.001, 0.5);
  }
  if (WithProbability(random, 0.2)) {
    const int n = skeleton->velocity_count();
    request.bounds = StepBounds{Eigen::VectorXd::Constant(n, -0.1),
                                Eigen::VectorXd::Constant(n, 0.05)};
  }
  return request;
}

SolveAnswer Ask(IkSolver& solver, const Request& request, double litter) {
  SolveAnswer answer;
  answer.positions = request.start;
  LitterStack(litter);
  solver.Solve(request.problem, request.options, request.from, answer.positions,
               answer.report, request.bounds ? &*request.bounds : nullptr);
  return answer;
}

TEST(SolverReuseTest, AnAnswerIsThatOfAFreshSolver) {
  Random random(1);
  std::vector<IkSolver> reused;
  for (InstructionSet level : SupportedInstructionSets()) {
    reused.emplace_back(level);
  }
  constexpr double kLitter[] = {std::numeric_limits<double>::quiet_NaN(), 1e300,
                                -1, 0};
  for (int i = 0; i < kProblems && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const Request request = AnyRequest(random);
    for (IkSolver& old : reused) {
      IkSolver fresh(old.instruction_set());
      const SolveAnswer want = Ask(fresh, request, 0);
      ExpectSameBits(want, Ask(old, request, kLitter[i % 4]));
      // The report is reused, too.
      ExpectSameBits(want, Ask(old, request, kLitter[(i + 1) % 4]));
    }
  }
}

// The methods that are asked for by name.
TEST(SolverReuseTest, OfEveryMethod) {
  Random random(2);
  IkSolver old;
  int asked = 0;
  for (int i = 0; i < kProblems && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    Request request = AnyRequest(random);
    for (SolverMethod method :
         {SolverMethod::kTwoLink, SolverMethod::kNewton,
          SolverMethod::kPseudoInverse, SolverMethod::kMinimalChange,
          SolverMethod::kFabrik}) {
      request.options.method = method;
      if (!IkSolver::Check(request.problem, request.options).ok()) continue;
      IkSolver fresh;
      ExpectSameBits(Ask(fresh, request, 0), Ask(old, request, 1e300));
      ++asked;
    }
  }
  EXPECT_GT(asked, kProblems / 10);
}

TEST(SolverReuseTest, BatchesDoNotRememberOthers) {
  Random random(3);
  BatchSolver old;
  for (int i = 0; i < kProblems / 4 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    Request request = AnyRequest(random);
    const int columns = 1 + UniformIndex(random, 12);
    const Eigen::MatrixXd starts = request.start.replicate(1, columns);
    std::vector<GoalTarget> targets;
    for (int c = 0; c < columns; ++c) {
      for (const Goal& goal : request.problem.goals()) {
        targets.push_back(TargetOf(goal.kind));
      }
    }
    const auto solve = [&](BatchSolver& solver, double litter,
                           BatchReport& report) {
      Eigen::MatrixXd positions = starts;
      LitterStack(litter);
      solver.Solve(request.problem, targets, request.options, request.from,
                   positions, report);
      return positions;
    };
    BatchSolver fresh;
    BatchReport want, got;
    EXPECT_EQ(solve(fresh, 0, want), solve(old, 1e300, got));
    EXPECT_EQ(want.outcomes, got.outcomes);
    EXPECT_EQ(want.iteration_counts, got.iteration_counts);
    EXPECT_EQ(want.position_errors_m, got.position_errors_m);
  }
}

}  // namespace
}  // namespace gelenk
