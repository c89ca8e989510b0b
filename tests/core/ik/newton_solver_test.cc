#include "gelenk/ik/newton_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "gelenk/ik/goal_equations.h"
#include "gelenk/ik/ik_solver.h"
#include "gelenk/math/pseudo_inverse.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/golden/newton.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::PandaArm;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::PoseGoalFor;
using ::gelenk::testing::PoseGoalsAt;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RandomVelocity;
using ::gelenk::testing::RotationGoalFor;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::StartNear;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Iterates agree to the rounding of a few dozen operations, relative.
constexpr double kIterateTolerance = 1e-9;
constexpr double kClosedFormTolerance = 1e-12;

// A position goal in the plane.
Goal PlanarGoal(double x, double y) {
  Goal goal = PositionGoalFor("tip", {x, y, 0});
  std::get<PositionGoal>(goal.kind).axes = {true, true, false};
  return goal;
}

SolverOptions Exactly(SolverMethod method, int max_iterations) {
  SolverOptions options;
  options.method = method;
  options.max_iterations = max_iterations;
  // Lengths of the golden chain are hundreds: rounding there is 1e-13.
  options.position_tolerance_m = 1e-12;
  options.rotation_tolerance_rad = 1e-12;
  return options;
}

struct Solved {
  Eigen::VectorXd positions;
  SolveReport report;
};

Solved SolveFrom(const IkProblem& problem, const Eigen::VectorXd& start,
                 const SolverOptions& options) {
  EXPECT_TRUE(IkSolver::Check(problem, options).ok())
      << IkSolver::Check(problem, options);
  IkSolver solver;
  Solved solved = {start, {}};
  solver.Solve(problem, options, SolveStart::kWarm, solved.positions,
               solved.report);
  EXPECT_EQ(solved.report.method, options.method);
  return solved;
}

class GoldenChainTest : public ::testing::Test {
 protected:
  const std::shared_ptr<const Skeleton> chain_ =
      PlanarChain({50, 400, 0}, {150, 200, 100});
  const IkProblem problem_ =
      IkProblem::Create(chain_, {PlanarGoal(350, 700)}).value();
  const Eigen::VectorXd start_ = Eigen::Vector3d(0.6, 1, -0.7);
};

TEST_F(GoldenChainTest, JacobianAndItsPseudoInverse) {
  GoalEquations equations(problem_);
  equations.Evaluate(start_);
  ASSERT_EQ(equations.jacobian().rows(), 2);
  ASSERT_EQ(equations.jacobian().cols(), 3);
  const PseudoInverse inverse = ComputePseudoInverse(equations.jacobian());
  EXPECT_EQ(inverse.rank, 2);
  for (int r = 0; r < 2; ++r) {
    for (int c = 0; c < 3; ++c) {
      const double j = golden::kJacobian[r][c];
      const double plus = golden::kPseudoInverse[c][r];
      EXPECT_NEAR(equations.jacobian()(r, c), j,
                  kClosedFormTolerance * std::abs(j));
      EXPECT_NEAR(inverse.matrix(c, r), plus,
                  kClosedFormTolerance * std::abs(plus));
    }
  }
}

TEST_F(GoldenChainTest, PseudoInverseIterates) {
  SolverOptions options = Exactly(SolverMethod::kPseudoInverse, 12);
  std::vector<Iterate> iterates;
  options.iterates = &iterates;
  const Solved solved = SolveFrom(problem_, start_, options);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  const auto& golden = golden::kPseudoInverseIterates;
  ASSERT_GE(iterates.size(), std::size(golden));
  for (size_t i = 0; i < std::size(golden); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(iterates[i].positions[k], golden[i][k], kIterateTolerance);
    }
    // Below 1e-9 the residual is the rounding of the angles.
    EXPECT_NEAR(iterates[i].residual, golden[i][3],
                kIterateTolerance * golden[i][3] + 1e-9);
  }
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(solved.positions[k], golden::kPseudoInverseLimit[k],
                kIterateTolerance);
  }
  EXPECT_NEAR(solved.report.change, 0.3295495067364494, kIterateTolerance);
}

TEST_F(GoldenChainTest, MinimalChange) {
  const Solved solved =
      SolveFrom(problem_, start_, Exactly(SolverMethod::kMinimalChange, 200));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_LE(solved.report.kkt_residual, kKktTolerance);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(solved.positions[k], golden::kMinimalChange[k],
                10 * kIterateTolerance);
  }
  EXPECT_NEAR(solved.report.change, golden::kMinimalChangeLength,
              kIterateTolerance);
  const Solved stepwise =
      SolveFrom(problem_, start_, Exactly(SolverMethod::kPseudoInverse, 12));
  EXPECT_LT(solved.report.change, stepwise.report.change - 1e-4);
}

TEST(NewtonSolverTest, SquareIterates) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1.1, 0.7});
  const IkProblem problem =
      IkProblem::Create(chain, {PlanarGoal(0.9, 0.8)}).value();
  SolverOptions options = Exactly(SolverMethod::kNewton, 10);
  std::vector<Iterate> iterates;
  options.iterates = &iterates;
  const Solved solved = SolveFrom(problem, Eigen::Vector2d(0.3, 0.8), options);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  const auto& golden = golden::kNewtonIterates;
  for (size_t i = 0; i < std::min(iterates.size(), std::size(golden)); ++i) {
    EXPECT_NEAR(iterates[i].positions[0], golden[i][0], kIterateTolerance);
    EXPECT_NEAR(iterates[i].positions[1], golden[i][1], kIterateTolerance);
    EXPECT_NEAR(iterates[i].residual, golden[i][2], kIterateTolerance);
  }
  // The rounding of the last step may need one more.
  EXPECT_GE(iterates.size(), std::size(golden) - 1);
}

TEST(NewtonSolverTest, StretchedIsSingular) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1.1, 0.7});
  const IkProblem problem =
      IkProblem::Create(chain, {PlanarGoal(0.9, 0.8)}).value();
  const Eigen::VectorXd start = Eigen::Vector2d(0.3, 0);
  const Solved solved =
      SolveFrom(problem, start, Exactly(SolverMethod::kNewton, 10));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kSingular);
  EXPECT_EQ(solved.report.iteration_count, 0);
  EXPECT_EQ(solved.positions, start);
}

TEST(NewtonSolverTest, WithAGoalOffThereAreTooFewEquations) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1.1, 0.7});
  IkProblem problem = IkProblem::Create(chain, {PlanarGoal(9, 9)}).value();
  problem.SetWeight(0, 0);
  const Eigen::VectorXd start = Eigen::Vector2d(0.3, 0.5);
  EXPECT_EQ(SolveFrom(problem, start, Exactly(SolverMethod::kNewton, 10))
                .report.outcome,
            SolveOutcome::kConverged)
      << "nothing is asked for";
}

TEST(NewtonSolverTest, WantsAsManyEquationsAsUnknowns) {
  SolverOptions options;
  options.method = SolverMethod::kNewton;
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1, 1});
  const IkProblem flat = IkProblem::Create(chain, {PlanarGoal(1, 1)}).value();
  EXPECT_THAT(ViolationLines(IkSolver::Check(flat, options)),
              ElementsAre("method: newton wants as many equations as unknowns, "
                          "got 2 equations and 3 unknowns"));
  const IkProblem spatial =
      IkProblem::Create(chain, {PositionGoalFor("tip", {1, 1, 0})}).value();
  EXPECT_TRUE(IkSolver::Check(spatial, options).ok());
}

// A frozen joint is no unknown: the other two have as many equations.
TEST(NewtonSolverTest, FrozenJointsStay) {
  SkeletonBuilder builder;
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 0.8, 0.6});
  for (const Joint& original : chain->joints()) {
    Joint joint = original;
    if (joint.id == "j1") joint.limits.lower = joint.limits.upper = {0.4};
    builder.AddJoint(joint);
  }
  builder.AddEndEffector(chain->end_effectors()[0]);
  const IkProblem problem =
      IkProblem::Create(builder.Build().value(), {PlanarGoal(1.2, 1.1)})
          .value();
  const Solved solved = SolveFrom(problem, Eigen::Vector3d(0.1, 0.4, 0.7),
                                  Exactly(SolverMethod::kNewton, 20));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(solved.positions[1], 0.4);
}

// The derivative of the residual itself, on the manifold, masks and weights
// included.
TEST(GoalEquationsTest, JacobianIsTheDerivative) {
  Random random(3);
  for (int round = 0; round < 30; ++round) {
    SkeletonRecipe recipe;
    recipe.limited = 0;
    const auto skeleton = RandomSkeleton(random, recipe);
    const std::string& id = skeleton->end_effectors()[0].id;
    std::vector<Goal> goals = {
        PoseGoalFor(id, testing::RandomTransform(random, 1)),
        RotationGoalFor(skeleton->joint(3).id, testing::RandomRotation(random)),
        PositionGoalFor(skeleton->joint(5).id,
                        testing::RandomVector(random, 1))};
    goals[0].weight = 0.3;
    std::get<PoseGoal>(goals[0].kind).rotation_scale_m_per_rad = 0.7;
    goals[1].id = "turn", goals[2].id = "point";
    std::get<PositionGoal>(goals[2].kind).axes = {true, false, true};
    const IkProblem problem = IkProblem::Create(skeleton, goals).value();
    GoalEquations equations(problem);
    const Eigen::VectorXd q = RandomPose(random, *skeleton);
    equations.Evaluate(q);
    // Rotation vectors near half a turn jump.
    if (equations.rotation_errors_rad()[0] > 3 ||
        equations.rotation_errors_rad()[1] > 3) {
      continue;
    }
    const Eigen::MatrixXd jacobian = equations.jacobian();
    ASSERT_EQ(jacobian.rows(), 6 + 3 + 2);
    for (int c = 0; c < jacobian.cols(); ++c) {
      constexpr double kStep = 1e-6;
      const auto at = [&](double step) {
        Eigen::VectorXd velocity =
            Eigen::VectorXd::Zero(skeleton->velocity_count());
        velocity[equations.unknowns()[c]] = step;
        Eigen::VectorXd moved = q;
        Integrate(*skeleton, q, velocity, moved);
        equations.Evaluate(moved);
        return Eigen::VectorXd(equations.residual());
      };
      const Eigen::VectorXd up = at(kStep);
      const Eigen::VectorXd difference = (up - at(-kStep)) / (2 * kStep);
      // Curvature near half a turn adds to the usual 1e-9.
      EXPECT_LT((difference - jacobian.col(c)).cwiseAbs().maxCoeff(), 1e-6)
          << "round " << round << " column " << c;
    }
  }
}

// On the manifold: spherical and free joints, stiffness, many goals.
class NewtonOnTreesTest : public ::testing::TestWithParam<SolverMethod> {};

TEST_P(NewtonOnTreesTest, ReachesPosesNearby) {
  Random random(4);
  int converged = 0;
  constexpr int kRounds = 40;
  for (int round = 0; round < kRounds; ++round) {
    SkeletonRecipe recipe;
    recipe.limited = 0;
    const auto skeleton = RandomSkeleton(random, recipe);
    const Eigen::VectorXd pose = RandomPose(random, *skeleton);
    const IkProblem problem =
        IkProblem::Create(skeleton, PoseGoalsAt(*skeleton, pose)).value();
    SolverOptions options = Exactly(GetParam(), 300);
    options.position_tolerance_m = options.rotation_tolerance_rad = 1e-9;
    const Solved solved =
        SolveFrom(problem, StartNear(random, *skeleton, pose, 0.1), options);
    if (solved.report.outcome == SolveOutcome::kConverged) ++converged;
  }
  EXPECT_GE(converged, kRounds - 3) << "undamped steps may leave";
}

INSTANTIATE_TEST_SUITE_P(Methods, NewtonOnTreesTest,
                         ::testing::Values(SolverMethod::kPseudoInverse,
                                           SolverMethod::kMinimalChange));

// Nothing within the solutions near the answer is nearer to the start.
TEST(MinimalChangeTest, NoNeighbourIsNearer) {
  Random random(5);
  const auto arm = PandaArm();
  for (int round = 0; round < 20; ++round) {
    const Eigen::VectorXd pose = RandomPoseWithinLimits(random, *arm);
    const Eigen::VectorXd start = StartNear(random, *arm, pose, 0.2);
    const IkProblem problem =
        IkProblem::Create(arm,
                          {PoseGoalFor("tip", EffectorPose(*arm, pose, "tip"))})
            .value();
    SolverOptions options = Exactly(SolverMethod::kMinimalChange, 500);
    options.position_tolerance_m = options.rotation_tolerance_rad = 1e-10;
    const Solved nearest = SolveFrom(problem, start, options);
    if (nearest.report.outcome != SolveOutcome::kConverged) continue;
    for (int k = 0; k < 10; ++k) {
      options.method = SolverMethod::kPseudoInverse;
      const Eigen::VectorXd other =
          nearest.positions + RandomVelocity(random, *arm, 0.02);
      const Solved neighbour = SolveFrom(problem, other, options);
      if (neighbour.report.outcome != SolveOutcome::kConverged) continue;
      EXPECT_GE((neighbour.positions - start).norm(),
                (nearest.positions - start).norm() - 1e-8);
    }
  }
}

// Stiff joints move less, and the change is measured by stiffness.
TEST(MinimalChangeTest, StiffJointsStay) {
  SkeletonBuilder builder;
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1, 1});
  for (const Joint& original : chain->joints()) {
    Joint joint = original;
    if (joint.id == "j0") joint.stiffness = {1e6};
    builder.AddJoint(joint);
  }
  builder.AddEndEffector(chain->end_effectors()[0]);
  const IkProblem problem =
      IkProblem::Create(builder.Build().value(), {PlanarGoal(1.5, 1)}).value();
  const Eigen::VectorXd start = Eigen::Vector3d(0.2, 0.9, 0.8);
  const Solved solved =
      SolveFrom(problem, start, Exactly(SolverMethod::kMinimalChange, 500));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_NEAR(solved.positions[0], start[0], 1e-5);
  EXPECT_GT((solved.positions - start).norm(), 0.01);
}

TEST(PseudoInverseSolverTest, OutOfReachSettlesOrSwingsButSaysSo) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1, 1});
  const IkProblem problem =
      IkProblem::Create(chain, {PlanarGoal(9, 0)}).value();
  const Solved straight = SolveFrom(problem, Eigen::Vector3d::Zero(),
                                    Exactly(SolverMethod::kPseudoInverse, 50));
  EXPECT_EQ(straight.report.outcome, SolveOutcome::kUnreachable);
  EXPECT_NEAR(straight.report.position_errors_m[0], 6, 1e-12);
  const Solved bent = SolveFrom(problem, Eigen::Vector3d(0.3, 0.2, 0.4),
                                Exactly(SolverMethod::kPseudoInverse, 50));
  EXPECT_NE(bent.report.outcome, SolveOutcome::kConverged);
  EXPECT_GE(bent.report.position_errors_m[0], 6 - 1e-12);
  const Eigen::VectorXd begin = Eigen::Vector3d(0.3, 0.2, 0.4);
  EXPECT_LE(bent.report.position_errors_m[0],
            (EffectorPose(*chain, begin, "tip").translation -
             Eigen::Vector3d(9, 0, 0))
                .norm())
      << "the best pose seen";
}

TEST(PseudoInverseSolverTest, LimitsHoldAndStall) {
  SkeletonBuilder builder;
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1});
  for (const Joint& original : chain->joints()) {
    Joint joint = original;
    joint.limits.lower = {-0.5};
    joint.limits.upper = {0.5};
    builder.AddJoint(joint);
  }
  builder.AddEndEffector(chain->end_effectors()[0]);
  const IkProblem problem =
      IkProblem::Create(builder.Build().value(), {PlanarGoal(0, 1.9)}).value();
  const Solved solved = SolveFrom(problem, Eigen::Vector2d(0.1, 0.2),
                                  Exactly(SolverMethod::kPseudoInverse, 100));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kStalledAtLimits);
  EXPECT_THAT(solved.report.limited_joints, ElementsAre(0, 1));
  EXPECT_EQ(solved.positions, Eigen::VectorXd::Constant(2, 0.5));
}

// Without a solution, least squares by weight.
TEST(PseudoInverseSolverTest, WeightsDecideWhereGoalsContradict) {
  SkeletonBuilder builder;
  Joint slide;
  slide.id = "slide";
  slide.type = JointType::kPrismatic;
  slide.axis = Eigen::Vector3d::UnitX();
  builder.AddJoint(slide);
  std::vector<Goal> goals = {PositionGoalFor("slide", {1, 0, 0}),
                             PositionGoalFor("slide", {2, 0, 0})};
  goals[0].id = "near", goals[1].id = "far";
  goals[1].weight = 3;
  const IkProblem problem =
      IkProblem::Create(builder.Build().value(), goals).value();
  const Solved solved = SolveFrom(problem, Eigen::VectorXd::Zero(1),
                                  Exactly(SolverMethod::kPseudoInverse, 10));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
  EXPECT_NEAR(solved.positions[0], (1.0 + 3 * 2) / 4, 1e-12);
}

TEST(PseudoInverseTest, PenroseConditionsWithoutFullRank) {
  Random random(6);
  for (int round = 0; round < 30; ++round) {
    const int rows = 1 + testing::UniformIndex(random, 6);
    const int columns = 1 + testing::UniformIndex(random, 8);
    const int rank = 1 + testing::UniformIndex(random, std::min(rows, columns));
    Eigen::MatrixXd left(rows, rank), right(rank, columns);
    for (double& x : left.reshaped()) x = testing::Uniform(random, -1, 1);
    for (double& x : right.reshaped()) x = testing::Uniform(random, -1, 1);
    const Eigen::MatrixXd a = left * right;
    const PseudoInverse p = ComputePseudoInverse(a);
    EXPECT_EQ(p.rank, rank);
    // Rounding, times the square of the condition of small random matrices.
    constexpr double kTolerance = 1e-8;
    const Eigen::MatrixXd ap = a * p.matrix, pa = p.matrix * a;
    EXPECT_LT((ap * a - a).norm(), kTolerance);
    EXPECT_LT((pa * p.matrix - p.matrix).norm(), kTolerance * p.matrix.norm());
    EXPECT_LT((ap - ap.transpose()).norm(), kTolerance);
    EXPECT_LT((pa - pa.transpose()).norm(), kTolerance);
  }
  EXPECT_EQ(ComputePseudoInverse(Eigen::MatrixXd::Zero(2, 3)).rank, 0);
  EXPECT_EQ(ComputePseudoInverse(Eigen::MatrixXd(0, 3)).matrix.rows(), 3);
}

// A stop is asked for before every step.
TEST(NewtonSolverTest, Stops) {
  const auto chain = PlanarChain({50, 400, 0}, {150, 200, 100});
  const IkProblem problem =
      IkProblem::Create(chain, {PlanarGoal(350, 700)}).value();
  NewtonSolver solver(SolverMethod::kPseudoInverse);
  int asked = 0;
  const StopCondition stop = {
      [](const void* context) {
        return ++*static_cast<int*>(const_cast<void*>(context)) > 2;
      },
      &asked};
  Eigen::VectorXd positions = Eigen::Vector3d(0.6, 1, -0.7);
  SolveReport report;
  solver.Solve(problem, Exactly(SolverMethod::kPseudoInverse, 10), positions,
               report, stop);
  EXPECT_EQ(report.outcome, SolveOutcome::kTimeLimit);
  EXPECT_EQ(report.iteration_count, 2);
}

}  // namespace
}  // namespace gelenk
