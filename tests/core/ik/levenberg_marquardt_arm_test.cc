// What the solver promises on arms, where it has kernels of its own: on every
// level of the instruction set, checked by the oracle and against the kernel of
// trees.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/ik/solve_arm.h"
#include "gelenk/math/rotation.h"
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
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RotationGoalFor;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::StartNear;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::UniformIndex;
using ::gelenk::testing::Ur5Arm;
using ::gelenk::testing::WithProbability;

// What the oracle and the solver may disagree on.
constexpr double kRounding = 1e-9;
// A stream's frame: each joint this near to its answer.
constexpr double kWarmDistance = 0.1;
// Energies of closest poses that differ by less are the same valley: trees stop
// where six iterations gain less than 1e-5.
constexpr double kSameEnergy = 1e-3;
// The finest that robots ask for, m and rad.
constexpr double kFine = 1e-5;

struct Solved {
  Eigen::VectorXd positions;
  SolveReport report;
};

SolverOptions FineOptions() {
  SolverOptions options;
  options.position_tolerance_m = kFine;
  options.rotation_tolerance_rad = kFine;
  return options;
}

Solved Solve(InstructionSet level, const IkProblem& problem,
             const SolverOptions& options, SolveStart from,
             const Eigen::VectorXd& start) {
  LevenbergMarquardtSolver solver(level);
  Solved solved;
  solved.positions = start;
  solver.Solve(problem, options, from, solved.positions, solved.report);
  return solved;
}

// Of joints without limits zero.
Eigen::VectorXd MiddleOf(const Skeleton& skeleton) {
  const PositionBounds& bounds = skeleton.position_bounds();
  const Eigen::ArrayXd middle = 0.5 * (bounds.lower + bounds.upper);
  return middle.isFinite().select(middle, 0);
}

// Arms of 6 to 10 joints, most of them with limits.
std::shared_ptr<const Skeleton> RandomArm(Random& random) {
  SkeletonRecipe recipe;
  recipe.types = {JointType::kRevolute, JointType::kRevolute,
                  JointType::kRevolute, JointType::kPrismatic};
  recipe.joint_count = 6 + UniformIndex(random, 5);
  recipe.branching = 0;
  recipe.mimicking = 0;
  recipe.frozen = 0.05;
  return RandomSkeleton(random, recipe);
}

class ArmTest : public ::testing::TestWithParam<InstructionSet> {
 protected:
  // An answer that claims to be there must be, whatever it claims must be true
  // and inside the limits.
  void ExpectHonest(const std::shared_ptr<const Skeleton>& skeleton,
                    const Goal& goal, const SolverOptions& options,
                    const Solved& solved) {
    const SolveReport& report = solved.report;
    EXPECT_LE(LimitExcess(*skeleton, solved.positions, nullptr), 0);
    const double position =
        OraclePositionError(*skeleton, goal, solved.positions);
    const double rotation =
        OracleRotationError(*skeleton, goal, solved.positions);
    EXPECT_NEAR(report.position_errors_m[0], position, kRounding);
    EXPECT_NEAR(report.rotation_errors_rad[0], rotation, 1e-7);
    if (report.outcome != SolveOutcome::kConverged) return;
    EXPECT_LE(position, options.position_tolerance_m + kRounding);
    EXPECT_LE(rotation, options.rotation_tolerance_rad + kRounding);
  }

  struct Tally {
    int solved = 0;
    int jumps = 0;
    int restarts = 0;
  };

  // Solves `count` targets, each of them in reach.
  Tally SolveMany(Random& random,
                  const std::shared_ptr<const Skeleton>& skeleton, int count,
                  SolveStart from) {
    Tally tally;
    const std::string tip = skeleton->end_effectors()[0].id;
    const SolverOptions options = FineOptions();
    IkProblem problem =
        IkProblem::Create(skeleton, {PoseGoalFor(tip, {})}).value();
    EXPECT_NE(problem.arm(), nullptr);
    LevenbergMarquardtSolver solver(GetParam());
    for (int i = 0; i < count; ++i) {
      const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *skeleton);
      const Goal goal = PoseGoalFor(tip, EffectorPose(*skeleton, truth, tip));
      problem.SetTarget(0, TargetOf(goal.kind));
      const Eigen::VectorXd start =
          from == SolveStart::kWarm
              ? StartNear(random, *skeleton, truth, kWarmDistance)
              : MiddleOf(*skeleton);
      Solved solved;
      solved.positions = start;
      solver.Solve(problem, options, from, solved.positions, solved.report);
      ExpectHonest(skeleton, goal, options, solved);
      tally.solved += solved.report.outcome == SolveOutcome::kConverged;
      tally.restarts += solved.report.restart_count > 0;
      tally.jumps +=
          (solved.positions - start).cwiseAbs().maxCoeff() > kArmJump;
    }
    return tally;
  }
};

TEST_P(ArmTest, WarmTargetsAreAllMetNearby) {
  Random random(1);
  constexpr int kTargets = 2000;
  for (const auto& arm : {PandaArm(), Ur5Arm()}) {
    const Tally tally = SolveMany(random, arm, kTargets, SolveStart::kWarm);
    EXPECT_EQ(tally.solved, kTargets);
    EXPECT_EQ(tally.jumps, 0);
    EXPECT_EQ(tally.restarts, 0);
  }
}

TEST_P(ArmTest, ColdTargetsAreAllMet) {
  Random random(2);
  constexpr int kTargets = 500;
  for (const auto& arm : {PandaArm(), Ur5Arm()}) {
    const Tally tally = SolveMany(random, arm, kTargets, SolveStart::kCold);
    EXPECT_EQ(tally.solved, kTargets);
    EXPECT_GT(tally.restarts, 0);
  }
}

// Elbow and wrist nearly or wholly straight, where the Jacobian loses rank.
TEST_P(ArmTest, WarmTargetsAtSingularitiesAreAllMetNearby) {
  Random random(3);
  const auto ur5 = Ur5Arm();
  const SolverOptions options = FineOptions();
  for (int i = 0; i < 1000; ++i) {
    Eigen::VectorXd truth = RandomPoseWithinLimits(random, *ur5);
    const double small = i % 3 == 0 ? 0 : Uniform(random, -0.02, 0.02);
    (i % 2 == 0 ? truth[2] : truth[4]) = small;
    const Goal goal = PoseGoalFor("tip", EffectorPose(*ur5, truth, "tip"));
    const IkProblem problem = IkProblem::Create(ur5, {goal}).value();
    const Eigen::VectorXd start = StartNear(random, *ur5, truth, kWarmDistance);
    const Solved solved =
        Solve(GetParam(), problem, options, SolveStart::kWarm, start);
    ExpectHonest(ur5, goal, options, solved);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged) << i;
    EXPECT_LE((solved.positions - start).cwiseAbs().maxCoeff(), kArmJump);
  }
}

TEST_P(ArmTest, RandomArmsMeetWarmTargets) {
  Random random(4);
  int solved = 0;
  int jumps = 0;
  constexpr int kArms = 60;
  constexpr int kTargets = 30;
  for (int i = 0; i < kArms; ++i) {
    const Tally tally =
        SolveMany(random, RandomArm(random), kTargets, SolveStart::kWarm);
    solved += tally.solved;
    jumps += tally.jumps;
  }
  EXPECT_EQ(solved, kArms * kTargets);
  EXPECT_LE(jumps, 1);
}

// Some of them take hundreds of restarts.
TEST_P(ArmTest, RandomArmsMeetColdTargets) {
  Random random(14);
  int solved = 0;
  constexpr int kArms = 30;
  constexpr int kTargets = 40;
  for (int i = 0; i < kArms; ++i) {
    solved += SolveMany(random, RandomArm(random), kTargets, SolveStart::kCold)
                  .solved;
  }
  EXPECT_GE(solved, kArms * kTargets - 1);
}

// A goal of weight zero beside it makes the same problem no arm.
IkProblem SolvedAsTree(const std::shared_ptr<const Skeleton>& skeleton,
                       const Goal& goal) {
  Goal off = PositionGoalFor(skeleton->joint(0).id, Eigen::Vector3d::Zero());
  off.id = "off";
  off.weight = 0;
  return IkProblem::Create(skeleton, {goal, off}).value();
}

// Goals of every kind, weighted and masked, some out of reach: the answer is as
// good as that of the kernel of trees.
TEST_P(ArmTest, AgreesWithTheKernelOfTrees) {
  Random random(5);
  int reached = 0;
  int missed = 0;
  int worse = 0;
  int better = 0;
  for (int i = 0; i < 400; ++i) {
    const auto skeleton = RandomArm(random);
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *skeleton);
    RigidTransform pose = EffectorPose(*skeleton, truth, "e0");
    const bool far = i % 3 == 0;
    if (far) pose.translation *= Uniform(random, 3, 6);
    Goal goal = PoseGoalFor("e0", pose);
    if (i % 5 == 1) goal = PositionGoalFor("e0", pose.translation);
    if (i % 5 == 2) goal = RotationGoalFor("e0", pose.rotation);
    goal.weight = Uniform(random, 0.3, 3);
    if (auto* kind = std::get_if<PoseGoal>(&goal.kind)) {
      kind->rotation_scale_m_per_rad = Uniform(random, 0.3, 2);
      kind->axes.x = WithProbability(random, 0.8);
    }
    if (auto* kind = std::get_if<PositionGoal>(&goal.kind)) {
      kind->axes.x = WithProbability(random, 0.8);
    }
    const IkProblem problem = IkProblem::Create(skeleton, {goal}).value();
    ASSERT_NE(problem.arm(), nullptr);
    const Eigen::VectorXd start =
        StartNear(random, *skeleton, truth, kWarmDistance);
    SolverOptions options;
    options.max_iterations = 1000;
    const Solved arm =
        Solve(GetParam(), problem, options, SolveStart::kWarm, start);
    const Solved tree = Solve(GetParam(), SolvedAsTree(skeleton, goal), options,
                              SolveStart::kWarm, start);
    ExpectHonest(skeleton, goal, options, arm);
    if (tree.report.outcome == SolveOutcome::kConverged) {
      ++reached;
      EXPECT_EQ(arm.report.outcome, SolveOutcome::kConverged);
      continue;
    }
    ++missed;
    const auto energy = [&](const SolveReport& report) {
      const auto* kind = std::get_if<PoseGoal>(&goal.kind);
      const double scale = kind ? kind->rotation_scale_m_per_rad : 1;
      const double chord = 2 * std::sin(0.5 * report.rotation_errors_rad[0]);
      return std::pow(report.position_errors_m[0], 2) +
             std::pow(scale * chord, 2);
    };
    worse += energy(arm.report) > energy(tree.report) * (1 + kSameEnergy);
    better += energy(arm.report) < energy(tree.report) * (1 - kSameEnergy);
  }
  // Now and then one of them finds a valley that is deeper.
  EXPECT_LE(worse, missed / 25);
  EXPECT_GE(better, worse);
  EXPECT_GT(reached, 200);
  EXPECT_GT(missed, 60);
}

// The first steps of both solve the same equations.
TEST_P(ArmTest, StiffJointsMoveAsLittleAsInTrees) {
  Random random(6);
  for (int i = 0; i < 50; ++i) {
    SkeletonBuilder builder;
    const auto plain = RandomArm(random);
    for (Joint joint : plain->joints()) {
      joint.limits = {};
      joint.stiffness = {Uniform(random, 0.1, 10)};
      builder.AddJoint(joint);
    }
    builder.AddEndEffector(plain->end_effectors()[0]);
    const auto skeleton = builder.Build().value();
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *skeleton);
    const Goal goal = PoseGoalFor("e0", EffectorPose(*skeleton, truth, "e0"));
    const Eigen::VectorXd start = StartNear(random, *skeleton, truth, 0.01);
    // Near the target both are Newton's method, whose answers differ by less
    // than their steps.
    const Solved arm =
        Solve(GetParam(), IkProblem::Create(skeleton, {goal}).value(),
              FineOptions(), SolveStart::kWarm, start);
    const Solved tree = Solve(GetParam(), SolvedAsTree(skeleton, goal),
                              FineOptions(), SolveStart::kWarm, start);
    EXPECT_NEAR(arm.report.change, tree.report.change,
                0.02 * tree.report.change + 1e-4);
  }
}

TEST_P(ArmTest, LimitsFromBothSides) {
  Joint joint;
  joint.id = "hinge";
  joint.type = JointType::kRevolute;
  joint.axis = Eigen::Vector3d::UnitZ();
  joint.limits.lower = {-0.5};
  joint.limits.upper = {0.75};
  RigidTransform tip;
  tip.translation = {1, 0, 0};
  const auto arm = SkeletonBuilder()
                       .AddJoint(joint)
                       .AddEndEffector({"tip", "hinge", tip})
                       .Build()
                       .value();
  const auto solve = [&](double angle) {
    RigidTransform target;
    target.rotation = ExpRotation({0, 0, angle});
    target.translation = target.rotation * tip.translation;
    return Solve(GetParam(),
                 IkProblem::Create(arm, {PoseGoalFor("tip", target)}).value(),
                 {}, SolveStart::kWarm, Eigen::VectorXd::Constant(1, 0.1));
  };
  for (double inside : {-0.5, -0.49, 0.74, 0.75}) {
    EXPECT_EQ(solve(inside).report.outcome, SolveOutcome::kConverged);
  }
  for (double outside : {-1.5, -0.51, 0.76, 1.5}) {
    const Solved solved = solve(outside);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kStalledAtLimits);
    EXPECT_EQ(solved.positions[0], outside < 0 ? -0.5 : 0.75);
    EXPECT_THAT(solved.report.limited_joints, ::testing::ElementsAre(0));
  }
}

// Out of reach a stream moves on smoothly: the closest pose from frame to frame
// by no more than the target.
TEST_P(ArmTest, BeyondReachTheClosestPoseFollowsTheTarget) {
  const auto arm = PlanarChain({0, 0, 0}, {0.5, 0.4, 0.3});
  IkProblem problem =
      IkProblem::Create(arm, {PositionGoalFor("tip", {2, 0, 0})}).value();
  LevenbergMarquardtSolver solver(GetParam());
  Eigen::VectorXd positions = Eigen::Vector3d(0.4, -0.5, 0.3);
  SolveReport report;
  for (double angle = 0; angle < 3; angle += 0.02) {
    const Eigen::Vector3d target(2 * std::cos(angle), 2 * std::sin(angle), 0);
    problem.SetTarget(0, target);
    const Eigen::VectorXd before = positions;
    solver.Solve(problem, {}, SolveStart::kWarm, positions, report);
    EXPECT_EQ(report.outcome, SolveOutcome::kUnreachable);
    EXPECT_NEAR(report.position_errors_m[0], 2 - 1.2, 1e-6);
    // Stretched, towards the target.
    EXPECT_NEAR(positions[1], 0, 1e-3);
    EXPECT_NEAR(positions[0], angle, 1e-3);
    if (angle > 0) {
      EXPECT_LE((positions - before).cwiseAbs().maxCoeff(), 0.03);
    }
  }
}

TEST_P(ArmTest, TheClosestPoseIsNoFartherThanTheStart) {
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    const auto skeleton = RandomArm(random);
    const Eigen::VectorXd start = RandomPoseWithinLimits(random, *skeleton);
    RigidTransform target = EffectorPose(*skeleton, start, "e0");
    target.translation *= Uniform(random, 2, 6);
    const Goal goal = PoseGoalFor("e0", target);
    for (SolveStart from : {SolveStart::kWarm, SolveStart::kCold}) {
      const Solved solved =
          Solve(GetParam(), IkProblem::Create(skeleton, {goal}).value(), {},
                from, start);
      ExpectHonest(skeleton, goal, {}, solved);
      const double chord =
          2 * std::sin(0.5 * solved.report.rotation_errors_rad[0]);
      EXPECT_LE(
          std::pow(solved.report.position_errors_m[0], 2) + std::pow(chord, 2),
          std::pow(OraclePositionError(*skeleton, goal, start), 2) +
              std::pow(OracleRotationError(*skeleton, goal, start), 2));
    }
  }
}

// Half a turn away the residual's skew part is zero.
TEST_P(ArmTest, HalfATurnAwayIsNotThere) {
  Joint joint;
  joint.type = JointType::kRevolute;
  SkeletonBuilder builder;
  const Eigen::Vector3d axes[] = {Eigen::Vector3d::UnitX(),
                                  Eigen::Vector3d::UnitY(),
                                  Eigen::Vector3d::UnitZ()};
  for (int i = 0; i < 3; ++i) {
    joint.id = "j" + std::to_string(i);
    joint.parent_id = i == 0 ? "" : "j" + std::to_string(i - 1);
    joint.axis = axes[i];
    builder.AddJoint(joint);
  }
  const auto wrist = builder.Build().value();
  for (const Eigen::Vector4d& xyzw :
       {Eigen::Vector4d(1, 0, 0, 0), Eigen::Vector4d(0, 1, 0, 0),
        Eigen::Vector4d(0, 0, 1, 0), Eigen::Vector4d(0.6, 0, 0.8, 0)}) {
    const Goal goal = RotationGoalFor("j2", QuaternionXyzw(xyzw.data()));
    for (SolveStart from : {SolveStart::kWarm, SolveStart::kCold}) {
      const Solved solved =
          Solve(GetParam(), IkProblem::Create(wrist, {goal}).value(), {}, from,
                Eigen::VectorXd::Zero(3));
      EXPECT_GT(solved.report.iteration_count, 0);
      EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
      ExpectHonest(wrist, goal, {}, solved);
    }
  }
}

TEST_P(ArmTest, ColdAnswersAreTheStartsOwnWhereItHasOne) {
  Random random(8);
  const auto panda = PandaArm();
  int from_start = 0;
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *panda);
    const IkProblem problem =
        IkProblem::Create(
            panda, {PoseGoalFor("tip", EffectorPose(*panda, truth, "tip"))})
            .value();
    SolverOptions options;
    options.max_restarts = 0;
    const Solved warm = Solve(GetParam(), problem, options, SolveStart::kWarm,
                              MiddleOf(*panda));
    const Solved cold =
        Solve(GetParam(), problem, {}, SolveStart::kCold, MiddleOf(*panda));
    if (cold.report.restart_count > 0) continue;
    ++from_start;
    // Unless the warm one found a nearer one still.
    const auto distance = [&](const Solved& solved) {
      return (solved.positions - MiddleOf(*panda)).cwiseAbs().maxCoeff();
    };
    EXPECT_LE(distance(warm), distance(cold) + 1e-12);
  }
  EXPECT_GT(from_start, 50);
}

TEST_P(ArmTest, AStartOfManyTurnsIsTaken) {
  const auto arm = PlanarChain({0, 0, 0}, {1, 1});
  const Eigen::Vector3d target(1, 1, 0);
  const IkProblem problem =
      IkProblem::Create(arm, {PositionGoalFor("tip", target)}).value();
  // Both sides of what the kernels of arms take.
  for (double turns : {10.0, 14000.0, 20000.0}) {
    const double whole = 2 * M_PI * turns;
    const Solved solved = Solve(GetParam(), problem, {}, SolveStart::kWarm,
                                Eigen::Vector2d(whole + 0.3, 0.9));
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged) << turns;
    EXPECT_NEAR(solved.positions[0], whole, 1);
    EXPECT_LE((EffectorPose(*arm, solved.positions, "tip").translation - target)
                  .norm(),
              1.01e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(
    EachLevel, ArmTest, ::testing::ValuesIn(SupportedInstructionSets()),
    [](const ::testing::TestParamInfo<InstructionSet>& info) {
      return std::string(InstructionSetName(info.param));
    });

}  // namespace
}  // namespace gelenk
