// The sparse kernel against a dense oracle: one step must solve the damped
// normal equations (J^T J + lambda S) dq = J^T e for some lambda > 0, with J
// from ComputeJacobian.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <memory>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/ik/goal_linearizer.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/kinematics/jacobian.h"
#include "gelenk/math/rotation.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_goals.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::kAimGoal;
using ::gelenk::testing::kHalfSpaceGoal;
using ::gelenk::testing::kPoleGoal;
using ::gelenk::testing::kPoseGoal;
using ::gelenk::testing::kPositionGoal;
using ::gelenk::testing::kRotationGoal;
using ::gelenk::testing::PoseGoalsAt;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomGoal;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeletonBuilder;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::StartNear;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::WithProbability;

// Of the gradient: rounding of the factorisation, and of reading dq off
// quaternions.
constexpr double kRelativeRounding = 1e-8;

// J^T J and J^T e of all goals, weighted, dense.
struct NormalEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
};

NormalEquations Linearized(const Skeleton& skeleton,
                           const std::vector<Goal>& goals,
                           const Eigen::VectorXd& positions) {
  const int columns = skeleton.velocity_count();
  NormalEquations equations = {Eigen::MatrixXd::Zero(columns, columns),
                               Eigen::VectorXd::Zero(columns)};
  WorldTransforms frames;
  ForwardKinematics(skeleton, positions, frames);
  for (const Goal& goal : goals) {
    const PoseGoal& pose = std::get<PoseGoal>(goal.kind);
    const EffectorFrame effector =
        skeleton.FindEffector(pose.end_effector_id).value();
    Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;
    ComputeJacobian(skeleton, positions, frames, effector, jacobian);
    const RigidTransform now =
        frames[effector.joint] * effector.joint_from_effector;
    Eigen::Matrix<double, 6, 1> error;
    error.head<3>() = pose.world_pose.translation - now.translation;
    // 2 sin(angle / 2) about the axis to the target.
    Eigen::Quaterniond turn =
        pose.world_pose.rotation * now.rotation.conjugate();
    if (turn.w() < 0) turn.coeffs() *= -1;
    error.tail<3>() = 2 * turn.vec();
    Eigen::Matrix<double, 6, 1> weights;
    const AxisMask& axes = pose.axes;
    weights << axes.x, axes.y, axes.z,
        Eigen::Vector3d::Constant(pose.rotation_scale_m_per_rad *
                                  pose.rotation_scale_m_per_rad);
    weights *= goal.weight;
    equations.matrix += jacobian.transpose() * weights.asDiagonal() * jacobian;
    equations.gradient += jacobian.transpose() * weights.asDiagonal() * error;
  }
  return equations;
}

// The step that one iteration takes.
Eigen::VectorXd FirstStep(const std::shared_ptr<const Skeleton>& skeleton,
                          const std::vector<Goal>& goals,
                          const Eigen::VectorXd& start, InstructionSet level) {
  SolverOptions options;
  options.max_iterations = 1;
  Eigen::VectorXd moved = start;
  SolveReport report;
  LevenbergMarquardtSolver(level).Solve(
      IkProblem::Create(skeleton, goals).value(), options, SolveStart::kWarm,
      moved, report);
  Eigen::VectorXd step(skeleton->velocity_count());
  Difference(*skeleton, start, moved, step);
  return step;
}

Eigen::VectorXd StiffnessOf(const Skeleton& skeleton) {
  Eigen::VectorXd stiffness = Eigen::VectorXd::Ones(skeleton.velocity_count());
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const Joint& joint = skeleton.joint(i);
    const int v = skeleton.span(i).velocity_offset;
    if (v < 0) continue;
    for (size_t k = 0; k < joint.stiffness.size(); ++k) {
      stiffness[v + k] = joint.stiffness[k];
    }
  }
  return stiffness;
}

// Some degrees of freedom made stiff or slack.
std::shared_ptr<const Skeleton> WithStiffness(Random& random,
                                              const Skeleton& skeleton) {
  SkeletonBuilder builder;
  for (Joint joint : skeleton.joints()) {
    if (WithProbability(random, 0.5)) {
      for (int k = 0; k < VelocityCount(joint.type); ++k) {
        joint.stiffness.push_back(Uniform(random, 0.1, 10));
      }
    }
    builder.AddJoint(joint);
  }
  for (const EndEffector& effector : skeleton.end_effectors()) {
    builder.AddEndEffector(effector);
  }
  return builder.Build().value();
}

void ExpectSolvesNormalEquations(const NormalEquations& equations,
                                 const Eigen::VectorXd& stiffness,
                                 const Eigen::VectorXd& step) {
  const Eigen::VectorXd left =
      equations.gradient - equations.matrix * step;  // lambda S dq
  const Eigen::VectorXd damped = stiffness.cwiseProduct(step);
  const double lambda = left.dot(damped) / damped.squaredNorm();
  EXPECT_GT(lambda, 0);
  EXPECT_LE((left - lambda * damped).norm(),
            kRelativeRounding * equations.gradient.norm());
}

void ExpectFirstStepsAgree(const SkeletonRecipe& recipe, uint64_t seed) {
  Random random(seed);
  int compared = 0;
  for (int tree = 0; tree < 100; ++tree) {
    const auto skeleton = WithStiffness(
        random, *RandomSkeletonBuilder(random, recipe).Build().value());
    if (skeleton->velocity_count() == 0) continue;
    const Eigen::VectorXd truth = RandomPose(random, *skeleton);
    std::vector<Goal> goals = PoseGoalsAt(*skeleton, truth);
    for (Goal& goal : goals) {
      PoseGoal& pose = std::get<PoseGoal>(goal.kind);
      goal.weight = Uniform(random, 0.5, 2);
      pose.rotation_scale_m_per_rad = Uniform(random, 0.5, 2);
      pose.axes.y = WithProbability(random, 0.7);
    }
    const Eigen::VectorXd start = StartNear(random, *skeleton, truth, 0.03);
    const NormalEquations equations = Linearized(*skeleton, goals, start);
    for (InstructionSet level : SupportedInstructionSets()) {
      const Eigen::VectorXd step = FirstStep(skeleton, goals, start, level);
      if (step.isZero(0)) continue;  // There already, or uphill.
      ++compared;
      ExpectSolvesNormalEquations(equations, StiffnessOf(*skeleton), step);
    }
  }
  EXPECT_GT(compared, 80);
}

TEST(FirstStepTest, SolvesTheNormalEquationsOnRandomTrees) {
  SkeletonRecipe recipe;
  recipe.limited = 0;
  recipe.mimicking = 0;
  ExpectFirstStepsAgree(recipe, 1);
}

TEST(FirstStepTest, SolvesTheNormalEquationsWithMimics) {
  SkeletonRecipe recipe;
  recipe.limited = 0;
  recipe.types = {JointType::kRevolute, JointType::kPrismatic,
                  JointType::kSpherical, JointType::kFixed};
  recipe.mimicking = 0.5;
  recipe.joint_count = 20;
  ExpectFirstStepsAgree(recipe, 2);
}

TEST(FirstStepTest, SolvesTheNormalEquationsOnBushyTrees) {
  SkeletonRecipe recipe;
  recipe.limited = 0;
  recipe.branching = 0.8;
  recipe.joint_count = 40;
  ExpectFirstStepsAgree(recipe, 3);
}

TEST(FirstStepTest, SolvesTheNormalEquationsOnLongChains) {
  SkeletonRecipe recipe;
  recipe.limited = 0;
  recipe.branching = 0;
  recipe.joint_count = 60;
  recipe.offset_m = 0.05;
  ExpectFirstStepsAgree(recipe, 4);
}

// The same of goals of every shape, mixed, with J from GoalLinearizer, which
// has its own test.
NormalEquations Linearized(const IkProblem& problem,
                           const Eigen::VectorXd& positions) {
  const int columns = problem.skeleton().velocity_count();
  NormalEquations equations = {Eigen::MatrixXd::Zero(columns, columns),
                               Eigen::VectorXd::Zero(columns)};
  GoalLinearizer linearizer;
  linearizer.SetProblem(problem);
  linearizer.MoveTo(positions);
  for (size_t g = 0; g < problem.goals().size(); ++g) {
    const kernel::TaskTarget& target = problem.targets()[g];
    const int count = GoalLinearizer::RowCount(target);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>
        jacobian(count, columns);
    kernel::GoalRows rows = {};
    linearizer.Evaluate(static_cast<int>(g), target, rows);
    linearizer.ComputeJacobian(static_cast<int>(g), target, rows, positions,
                               jacobian);
    for (int r = 0; r < count; ++r) {
      const double scale =
          target.row_scale[r < target.translation_rows ? r : 3];
      const Eigen::VectorXd row = scale * jacobian.row(r);
      equations.matrix += row * row.transpose();
      equations.gradient += scale * rows.residual[r] * row;
    }
  }
  return equations;
}

TEST(FirstStepTest, SolvesTheNormalEquationsOfEveryShape) {
  Random random(5);
  SkeletonRecipe recipe;
  recipe.limited = 0;
  int compared = 0;
  for (int tree = 0; tree < 150; ++tree) {
    recipe.branching = Uniform(random, 0, 0.8);
    const auto skeleton = WithStiffness(
        random, *RandomSkeletonBuilder(random, recipe).Build().value());
    if (skeleton->velocity_count() == 0) continue;
    const Eigen::VectorXd truth = RandomPose(random, *skeleton);
    std::vector<Goal> goals;
    for (int kind : {kPoseGoal, kRotationGoal, kAimGoal, kPoleGoal,
                     kHalfSpaceGoal, kPositionGoal, kAimGoal}) {
      const auto goal = RandomGoal(random, *skeleton, kind, truth);
      if (!goal) continue;
      goals.push_back(
          {absl::StrCat("g", goals.size()), Uniform(random, 0.5, 2), *goal});
    }
    const Eigen::VectorXd start = StartNear(random, *skeleton, truth, 0.03);
    const IkProblem problem = IkProblem::Create(skeleton, goals).value();
    const NormalEquations equations = Linearized(problem, start);
    for (InstructionSet level : SupportedInstructionSets()) {
      const Eigen::VectorXd step = FirstStep(skeleton, goals, start, level);
      if (step.isZero(0)) continue;  // There already, or uphill.
      if (step.cwiseAbs().maxCoeff() > 1) continue;  // Cut.
      ++compared;
      ExpectSolvesNormalEquations(equations, StiffnessOf(*skeleton), step);
    }
  }
  EXPECT_GT(compared, 150);
}

}  // namespace
}  // namespace gelenk
