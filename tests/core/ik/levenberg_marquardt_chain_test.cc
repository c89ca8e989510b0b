// Serial chains with one position goal, which have a kernel of their own: what
// LevenbergMarquardtSolver promises, it keeps there too. Answers are checked by
// the matrix oracle and by the limits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/kinematics/jacobian.h"
#include "gelenk/math/rotation.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::OraclePositionError;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeletonBuilder;
using ::gelenk::testing::RandomTransform;
using ::gelenk::testing::RandomVector;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::StartNear;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::UniformIndex;
using ::gelenk::testing::WithProbability;

// What the oracle and the solver may disagree on.
constexpr double kRounding = 1e-9;
// How near to the least distance a patient attempt gets before its gains are
// not worth an iteration.
constexpr double kNearest = 1e-4;
// By how much an answer may break a limit.
constexpr double kLimitExcess = 1e-9;

// `link_count` links of equal length, 1 m together, a joint of `type` at the
// foot of each; the last ends at "tip".
std::shared_ptr<const Skeleton> EqualLinks(int link_count, JointType type,
                                           const JointLimits& limits = {}) {
  SkeletonBuilder builder;
  for (int i = 0; i < link_count; ++i) {
    Joint joint;
    joint.id = absl::StrCat("j", i);
    if (i > 0) {
      joint.parent_id = absl::StrCat("j", i - 1);
      joint.parent_from_joint.translation.x() = 1.0 / link_count;
    }
    joint.type = type;
    joint.axis = type == JointType::kSpherical ? Eigen::Vector3d::UnitX()
                                               : Eigen::Vector3d::UnitZ();
    joint.limits = limits;
    builder.AddJoint(joint);
  }
  RigidTransform tip;
  tip.translation.x() = 1.0 / link_count;
  builder.AddEndEffector({"tip", absl::StrCat("j", link_count - 1), tip});
  return builder.Build().value();
}

JointLimits Range(double lower, double upper) {
  JointLimits limits;
  limits.lower = {lower};
  limits.upper = {upper};
  return limits;
}

// Joints one after the other, some fixed, with skew axes and rests.
SkeletonRecipe ChainRecipe(int joint_count) {
  SkeletonRecipe recipe;
  recipe.joint_count = joint_count;
  recipe.types = {JointType::kRevolute, JointType::kRevolute,
                  JointType::kPrismatic, JointType::kSpherical,
                  JointType::kFixed};
  recipe.branching = 0;
  recipe.mimicking = 0;
  recipe.offset_m = 0.3;
  return recipe;
}

struct Solved {
  Eigen::VectorXd positions;
  SolveReport report;
};

Solved Solve(const IkProblem& problem, const Eigen::VectorXd& start,
             SolveStart from, const SolverOptions& options = {},
             InstructionSet level = BestInstructionSet()) {
  Solved solved;
  solved.positions = start;
  LevenbergMarquardtSolver(level).Solve(problem, options, from,
                                        solved.positions, solved.report);
  return solved;
}

Solved Solve(const std::shared_ptr<const Skeleton>& skeleton, const Goal& goal,
             SolveStart from, const SolverOptions& options = {}) {
  return Solve(IkProblem::Create(skeleton, {goal}).value(),
               NeutralPositions(*skeleton), from, options);
}

class ChainTest : public ::testing::TestWithParam<InstructionSet> {};

INSTANTIATE_TEST_SUITE_P(
    EachLevel, ChainTest, ::testing::ValuesIn(SupportedInstructionSets()),
    [](const ::testing::TestParamInfo<InstructionSet>& info) {
      return std::string(InstructionSetName(info.param));
    });

// The first step dq of a solve has (J^T W J + lambda S) dq = J^T W e for one
// lambda, with Jacobians that know nothing of segments.
TEST_P(ChainTest, FirstStepSolvesTheNormalEquations) {
  constexpr double kRelativeRounding = 1e-9;
  Random random(1);
  int compared = 0;
  for (int chain = 0; chain < 200; ++chain) {
    SkeletonRecipe recipe = ChainRecipe(1 + UniformIndex(random, 40));
    recipe.limited = 0;
    const auto bare = RandomSkeletonBuilder(random, recipe).Build().value();
    SkeletonBuilder builder;
    Eigen::VectorXd stiffness = Eigen::VectorXd::Ones(bare->velocity_count());
    for (int i = 0; i < bare->joint_count(); ++i) {
      Joint joint = bare->joint(i);
      if (WithProbability(random, 0.5)) {
        for (int k = 0; k < VelocityCount(joint.type); ++k) {
          joint.stiffness.push_back(Uniform(random, 0.1, 10));
          stiffness[bare->span(i).velocity_offset + k] = joint.stiffness[k];
        }
      }
      builder.AddJoint(joint);
    }
    RigidTransform tip;
    tip.translation = RandomVector(random, 0.3);
    builder.AddEndEffector(
        {"tip", bare->joint(bare->joint_count() - 1).id, tip});
    const auto skeleton = builder.Build().value();
    if (skeleton->velocity_count() == 0) continue;

    const Eigen::VectorXd start = RandomPose(random, *skeleton);
    const RigidTransform world_from_skeleton = RandomTransform(random, 1);
    WorldTransforms frames;
    ForwardKinematics(*skeleton, start, world_from_skeleton, frames);
    const EffectorFrame effector = skeleton->FindEffector("tip").value();
    const Eigen::Vector3d world_tip =
        frames[effector.joint] * effector.joint_from_effector.translation;
    Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;
    ComputeJacobian(*skeleton, start, frames, effector, jacobian);

    PositionGoal position;
    position.end_effector_id = "tip";
    position.world_position = world_tip + RandomVector(random, 0.02);
    position.axes.y = WithProbability(random, 0.7);
    const double weight = Uniform(random, 0.5, 2);
    IkProblem problem =
        IkProblem::Create(skeleton, {{"goal", weight, position}}).value();
    problem.SetWorldFromSkeleton(world_from_skeleton);
    const Eigen::Vector3d weights(weight, position.axes.y ? weight : 0, weight);
    const Eigen::MatrixXd j = jacobian.topRows<3>();
    const Eigen::VectorXd gradient = j.transpose() * weights.asDiagonal() *
                                     (position.world_position - world_tip);

    SolverOptions options;
    options.max_iterations = 1;
    const Solved solved =
        Solve(problem, start, SolveStart::kWarm, options, GetParam());
    Eigen::VectorXd step(skeleton->velocity_count());
    Difference(*skeleton, start, solved.positions, step);
    // There already, uphill, or out of reach.
    if (step.isZero(0) || solved.report.iteration_count == 0) continue;
    ++compared;
    const Eigen::VectorXd left =
        gradient - j.transpose() * weights.asDiagonal() * (j * step);
    const Eigen::VectorXd damped = stiffness.cwiseProduct(step);
    const double lambda = left.dot(damped) / damped.squaredNorm();
    EXPECT_GT(lambda, 0);
    EXPECT_LE((left - lambda * damped).norm(),
              kRelativeRounding * gradient.norm());
  }
  EXPECT_GT(compared, 150);
}

TEST_P(ChainTest, ReachesWhatRandomPosesReach) {
  Random random(2);
  int converged = 0;
  constexpr int kChains = 300;
  for (int chain = 0; chain < kChains; ++chain) {
    const auto skeleton =
        RandomSkeletonBuilder(random, ChainRecipe(3 + UniformIndex(random, 60)))
            .Build()
            .value();
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *skeleton);
    const std::string id = skeleton->end_effectors()[0].id;
    const Goal goal =
        PositionGoalFor(id, EffectorPose(*skeleton, truth, id).translation);
    const bool cold = chain % 2 == 0;
    Solved solved =
        Solve(IkProblem::Create(skeleton, {goal}).value(),
              cold ? NeutralPositions(*skeleton)
                   : StartNear(random, *skeleton, truth, 0.1),
              cold ? SolveStart::kCold : SolveStart::kWarm, {}, GetParam());
    EXPECT_LE(LimitExcess(*skeleton, solved.positions, nullptr), kLimitExcess);
    EXPECT_TRUE(CheckPositions(*skeleton, solved.positions).ok());
    const double error = OraclePositionError(*skeleton, goal, solved.positions);
    EXPECT_NEAR(solved.report.position_errors_m[0], error, kRounding);
    EXPECT_EQ(solved.report.rotation_errors_rad[0], 0);
    if (solved.report.outcome != SolveOutcome::kConverged) continue;
    ++converged;
    EXPECT_LE(error, SolverOptions().position_tolerance_m + kRounding);
  }
  // A warm start may be in a corner of its limits.
  EXPECT_GE(converged, kChains - 2);
}

// Hundred links, from straight; what the benchmarks do.
TEST_P(ChainTest, ReachesWithHundredLinks) {
  Random random(3);
  JointLimits ball;
  ball.swing_cone_rad = 0.6;
  ball.twist_lower_rad = -0.4;
  ball.twist_upper_rad = 0.4;
  SolverOptions options;
  options.position_tolerance_m = 1e-5;
  for (const auto& skeleton :
       {EqualLinks(100, JointType::kRevolute, Range(-2.0944, 2.0944)),
        EqualLinks(100, JointType::kRevolute, Range(-0.05, 0.05)),
        EqualLinks(100, JointType::kSpherical),
        EqualLinks(100, JointType::kSpherical, ball)}) {
    for (int i = 0; i < 20; ++i) {
      const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *skeleton);
      const Goal goal = PositionGoalFor(
          "tip", EffectorPose(*skeleton, truth, "tip").translation);
      const Solved solved = Solve(IkProblem::Create(skeleton, {goal}).value(),
                                  NeutralPositions(*skeleton),
                                  SolveStart::kCold, options, GetParam());
      EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
      EXPECT_LE(OraclePositionError(*skeleton, goal, solved.positions),
                options.position_tolerance_m + kRounding);
      EXPECT_LE(LimitExcess(*skeleton, solved.positions, nullptr),
                kLimitExcess);
    }
  }
}

// In closed form without limits, by steps with limits that do not matter.
TEST(ChainReachTest, BeyondItsLengthItStretchesOut) {
  const Eigen::Vector3d target = Eigen::Vector3d(0.6, 0.8, 0) * 1.5;
  for (SolveStart from : {SolveStart::kCold, SolveStart::kWarm}) {
    for (JointType type : {JointType::kRevolute, JointType::kSpherical}) {
      const auto chain = EqualLinks(40, type);
      const Solved solved = Solve(chain, PositionGoalFor("tip", target), from);
      EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
      EXPECT_EQ(solved.report.restart_count, 0);
      EXPECT_NEAR(solved.report.position_errors_m[0], 0.5, kRounding);
      EXPECT_LE((EffectorPose(*chain, solved.positions, "tip").translation -
                 target / 1.5)
                    .norm(),
                kRounding);
    }
  }
  const auto limited = EqualLinks(40, JointType::kRevolute, Range(-2, 2));
  const Solved solved =
      Solve(limited, PositionGoalFor("tip", target), SolveStart::kCold);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
  EXPECT_NEAR(solved.report.position_errors_m[0], 0.5, kNearest);
}

TEST(ChainReachTest, InsideTheHoleOfItsAnnulusItFoldsUp) {
  // The first link is longer by 0.5 m than all others together.
  std::vector<double> lengths = {1.5};
  for (int i = 0; i < 20; ++i) lengths.push_back(0.05);
  const auto chain = PlanarChain({0.1, 0, 0}, lengths);
  for (const Eigen::Vector3d& target :
       {Eigen::Vector3d(0.4, 0, 0), Eigen::Vector3d(0.1, 0, 0)}) {
    const Solved solved =
        Solve(chain, PositionGoalFor("tip", target), SolveStart::kCold);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
    EXPECT_NEAR(solved.report.position_errors_m[0], 0.6 - target.x(),
                kRounding);
  }
}

// The answer follows a target that moves out of reach and back.
TEST(ChainReachTest, IsContinuousAcrossTheBorderOfItsReach) {
  const auto chain = EqualLinks(20, JointType::kSpherical);
  IkProblem problem =
      IkProblem::Create(chain, {PositionGoalFor("tip", {0.9, 0.1, 0})}).value();
  SolverOptions options;
  options.position_tolerance_m = 1e-6;
  LevenbergMarquardtSolver solver;
  SolveReport report;
  Eigen::VectorXd positions = NeutralPositions(*chain);
  positions = Solve(problem, positions, SolveStart::kCold, options).positions;
  Eigen::VectorXd before = positions;
  for (int frame = 0; frame <= 100; ++frame) {
    // From 0.9 m out to 1.1 m, a millimetre below the length at most a frame.
    const double distance = 1.0 + 0.1 * std::sin(0.02 * frame - 1.0);
    problem.SetTarget(0, GoalTarget(Eigen::Vector3d(distance, 0.1, 0)));
    solver.Solve(problem, options, SolveStart::kWarm, positions, report);
    Eigen::VectorXd change(chain->velocity_count());
    Difference(*chain, before, positions, change);
    // At the border a chain bends by the root of what is left.
    EXPECT_LE(change.cwiseAbs().maxCoeff(), 0.2) << frame;
    before = positions;
  }
}

TEST(ChainReachTest, OutOfItsPlaneItComesAsNearAsThePlane) {
  const auto chain = EqualLinks(30, JointType::kRevolute);
  const Solved solved =
      Solve(chain, PositionGoalFor("tip", {0.3, 0.4, 0.25}), SolveStart::kCold);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
  EXPECT_NEAR(solved.report.position_errors_m[0], 0.25, 1e-6);
}

TEST(ChainReachTest, MaskedAxesDoNotCount) {
  const auto chain = EqualLinks(30, JointType::kRevolute);
  Goal goal = PositionGoalFor("tip", {0.3, 5, 0.25});
  std::get<PositionGoal>(goal.kind).axes = {true, false, false};
  const Solved solved = Solve(chain, goal, SolveStart::kCold);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_NEAR(EffectorPose(*chain, solved.positions, "tip").translation.x(),
              0.3, SolverOptions().position_tolerance_m);
}

// The tip of a chain with all its angles at 0.02, and just short of it and
// beyond.
TEST(ChainLimitTest, StallsAtLimitsOnlyBeyondThem) {
  constexpr int kLinks = 50;
  const auto chain =
      EqualLinks(kLinks, JointType::kRevolute, Range(-0.03, 0.02));
  const auto tip_at = [&](double angle) {
    return EffectorPose(*EqualLinks(kLinks, JointType::kRevolute),
                        Eigen::VectorXd::Constant(kLinks, angle), "tip")
        .translation;
  };
  for (double sign : {1.0, -1.0}) {
    const double limit = sign > 0 ? 0.02 : -0.03;
    const Solved inside = Solve(
        chain, PositionGoalFor("tip", tip_at(0.99 * limit)), SolveStart::kWarm);
    EXPECT_EQ(inside.report.outcome, SolveOutcome::kConverged);
    const Solved beyond = Solve(
        chain, PositionGoalFor("tip", tip_at(1.5 * limit)), SolveStart::kWarm);
    EXPECT_EQ(beyond.report.outcome, SolveOutcome::kStalledAtLimits);
    EXPECT_LE(LimitExcess(*chain, beyond.positions, nullptr), 0);
    // All that help are named; the last ones turn the tip the other way.
    EXPECT_GT(beyond.report.limited_joints.size(), size_t(kLinks / 2));
    EXPECT_EQ(beyond.positions[0], limit);
  }
}

TEST(ChainLimitTest, FrozenJointsStayFrozen) {
  const auto chain = EqualLinks(20, JointType::kRevolute, Range(0.1, 0.1));
  const Solved solved =
      Solve(chain, PositionGoalFor("tip", {0.5, 0, 0}), SolveStart::kWarm);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kStalledAtLimits);
  EXPECT_EQ(solved.positions, Eigen::VectorXd::Constant(20, 0.1));
}

TEST(ChainLimitTest, BallJointsStallOnTheirCones) {
  JointLimits limits;
  limits.swing_cone_rad = 0.02;
  const auto chain = EqualLinks(30, JointType::kSpherical, limits);
  const Solved solved =
      Solve(chain, PositionGoalFor("tip", {0, 0, 0.9}), SolveStart::kWarm);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kStalledAtLimits);
  EXPECT_LE(LimitExcess(*chain, solved.positions, nullptr), kLimitExcess);
  EXPECT_GT(solved.report.limited_joints.size(), size_t(15));
}

TEST(ChainReachTest, StraightChainFindsTheTargetOnItsLine) {
  for (JointType type : {JointType::kRevolute, JointType::kSpherical}) {
    for (double x : {0.5, -0.5, 0.0}) {
      const auto chain = EqualLinks(30, type);
      const Goal goal = PositionGoalFor("tip", {x, 0, 0});
      const Solved solved = Solve(chain, goal, SolveStart::kCold);
      EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged) << x;
      EXPECT_LE(OraclePositionError(*chain, goal, solved.positions),
                SolverOptions().position_tolerance_m + kRounding);
    }
  }
}

// Frame by frame, also where it reaches out for what it cannot reach.
TEST_P(ChainTest, KeepsToTheLargestStepOfAFrame) {
  const auto chain = EqualLinks(40, JointType::kRevolute);
  SolverOptions options;
  options.max_step = 0.01;
  for (double distance : {0.5, 2.0}) {
    const Goal goal = PositionGoalFor("tip", {0, distance, 0});
    const IkProblem problem = IkProblem::Create(chain, {goal}).value();
    LevenbergMarquardtSolver solver(GetParam());
    Eigen::VectorXd positions = Eigen::VectorXd::Constant(40, 0.02);
    SolveReport report;
    double error = OraclePositionError(*chain, goal, positions);
    for (int frame = 0; frame < 5; ++frame) {
      const Eigen::VectorXd before = positions;
      solver.Solve(problem, options, SolveStart::kWarm, positions, report);
      EXPECT_LE((positions - before).cwiseAbs().maxCoeff(),
                *options.max_step + kRounding);
      const double now = OraclePositionError(*chain, goal, positions);
      EXPECT_LT(now, error);
      error = now;
    }
  }
}

TEST_P(ChainTest, TakesAnglesOfManyTurns) {
  const auto chain = EqualLinks(30, JointType::kRevolute);
  const Goal goal = PositionGoalFor("tip", {0.3, 0.4, 0});
  Eigen::VectorXd start = Eigen::VectorXd::Constant(30, 0.01);
  start[7] = 2 * M_PI * 50000;
  const Solved solved = Solve(IkProblem::Create(chain, {goal}).value(), start,
                              SolveStart::kWarm, {}, GetParam());
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_NEAR(solved.positions[7], start[7], 3);
  // A turn of this size has digits down to 1e-10 only.
  EXPECT_LE(OraclePositionError(*chain, goal, solved.positions),
            SolverOptions().position_tolerance_m + kRounding);
}

TEST(ChainTargetTest, GoalOfWeightZeroIsOff) {
  const auto chain = EqualLinks(30, JointType::kRevolute);
  Goal goal = PositionGoalFor("tip", {0.3, 0.4, 0});
  goal.weight = 0;
  const Solved solved = Solve(chain, goal, SolveStart::kCold);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(solved.report.position_errors_m[0], 0);
  EXPECT_EQ(solved.positions, NeutralPositions(*chain));
}

TEST_P(ChainTest, SameRequestSameBits) {
  Random random(4);
  LevenbergMarquardtSolver old(GetParam());
  for (int i = 0; i < 30; ++i) {
    const auto skeleton =
        RandomSkeletonBuilder(random, ChainRecipe(3 + UniformIndex(random, 40)))
            .Build()
            .value();
    const std::string id = skeleton->end_effectors()[0].id;
    // Some of them out of reach.
    const Eigen::Vector3d target =
        EffectorPose(*skeleton, RandomPose(random, *skeleton), id).translation;
    const IkProblem problem =
        IkProblem::Create(skeleton, {PositionGoalFor(id, target)}).value();
    SolverOptions options;
    options.max_restarts = 3;
    const Eigen::VectorXd start = RandomPoseWithinLimits(random, *skeleton);
    const Solved fresh =
        Solve(problem, start, SolveStart::kCold, options, GetParam());
    Solved again = {start, {}};
    old.Solve(problem, options, SolveStart::kCold, again.positions,
              again.report);
    EXPECT_EQ(fresh.positions, again.positions);
    EXPECT_EQ(fresh.report.iteration_count, again.report.iteration_count);
    EXPECT_EQ(fresh.report.limited_joints, again.report.limited_joints);
    EXPECT_EQ(fresh.report.change, again.report.change);
  }
}

// Warm problems converge quadratically, so that differences of rounding do not
// grow; but where a joint is on its limit within rounding, the step that frees
// it or not leads to another of the many answers of a long chain, as near.
TEST_P(ChainTest, AgreesWithTheBaseline) {
  constexpr double kLevelRounding = 1e-9;
  constexpr double kOtherAnswer = 1e-4;
  constexpr int kMostOthers = 2;
  int others = 0;
  Random random(5);
  for (int i = 0; i < 60; ++i) {
    const auto skeleton =
        RandomSkeletonBuilder(random, ChainRecipe(3 + UniformIndex(random, 40)))
            .Build()
            .value();
    if (skeleton->position_count() == 0) continue;
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *skeleton);
    const std::string id = skeleton->end_effectors()[0].id;
    const IkProblem problem =
        IkProblem::Create(
            skeleton, {PositionGoalFor(
                          id, EffectorPose(*skeleton, truth, id).translation)})
            .value();
    const Eigen::VectorXd start = StartNear(random, *skeleton, truth, 0.03);
    const Solved want =
        Solve(problem, start, SolveStart::kWarm, {}, InstructionSet::kBaseline);
    const Solved got = Solve(problem, start, SolveStart::kWarm, {}, GetParam());
    EXPECT_EQ(got.report.outcome, want.report.outcome);
    const double difference =
        (got.positions - want.positions).cwiseAbs().maxCoeff();
    EXPECT_LE(difference, kOtherAnswer);
    others += difference > kLevelRounding;
  }
  EXPECT_LE(others, kMostOthers);
}

}  // namespace
}  // namespace gelenk
