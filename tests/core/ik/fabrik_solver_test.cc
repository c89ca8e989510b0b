// FABRIK on random chains. Answers are checked by the matrix oracle.
#include "gelenk/ik/fabrik_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gelenk/ik/ik_solver.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/core/ik/bone_chains.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"

namespace gelenk {
namespace {

using ::gelenk::testing::BoneJoints;
using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::EqualBones;
using ::gelenk::testing::OraclePositionError;
using ::gelenk::testing::PandaArm;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::PoseGoalFor;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomBones;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::UniformIndex;
using ::testing::HasSubstr;

// What the oracle and the solver may disagree on: rounding along the chain.
constexpr double kRounding = 1e-12;

struct Solved {
  Eigen::VectorXd positions;
  SolveReport report;
};

Solved Solve(const std::shared_ptr<const Skeleton>& skeleton, const Goal& goal,
             const Eigen::VectorXd& start, const SolverOptions& options = {}) {
  Solved solved = {start, {}};
  FabrikSolver().Solve(IkProblem::Create(skeleton, {goal}).value(), options,
                       solved.positions, solved.report);
  return solved;
}

class FabrikTest : public ::testing::TestWithParam<BoneJoints> {};

INSTANTIATE_TEST_SUITE_P(EachKind, FabrikTest,
                         ::testing::Values(BoneJoints::kHinges,
                                           BoneJoints::kSpherical,
                                           BoneJoints::kGimbals));

TEST_P(FabrikTest, ReachesWhatRandomPosesReach) {
  Random random(1);
  SolverOptions options;
  options.position_tolerance_m = 1e-5;
  int converged = 0;
  for (int i = 0; i < 200; ++i) {
    const auto skeleton =
        RandomBones(random, GetParam(), 4 + UniformIndex(random, 40));
    const Goal goal = PositionGoalFor(
        "tip", EffectorPose(*skeleton, RandomPose(random, *skeleton), "tip")
                   .translation);
    Solved solved =
        Solve(skeleton, goal, RandomPose(random, *skeleton), options);
    const double error = OraclePositionError(*skeleton, goal, solved.positions);
    EXPECT_NEAR(solved.report.position_errors_m[0], error, kRounding);
    EXPECT_TRUE(CheckPositions(*skeleton, solved.positions).ok());
    if (solved.report.outcome != SolveOutcome::kConverged) continue;
    ++converged;
    EXPECT_LE(error, options.position_tolerance_m);
  }
  // Near the border of what a chain can reach it creeps.
  EXPECT_GE(converged, 196);
}

TEST_P(FabrikTest, OutOfReachItIsStraightAtTheTarget) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const int count = 1 + UniformIndex(random, 20);
    const auto skeleton = EqualBones(count, GetParam());
    const Eigen::Vector3d direction =
        Eigen::Vector3d(0.6, 0.8, GetParam() == BoneJoints::kHinges ? 0 : 0.5)
            .normalized();
    const Solved solved =
        Solve(skeleton, PositionGoalFor("tip", 1.5 * direction),
              RandomPose(random, *skeleton));
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
    EXPECT_EQ(solved.report.iteration_count, 0);
    EXPECT_NEAR(solved.report.position_errors_m[0], 0.5, kRounding);
    EXPECT_LE((EffectorPose(*skeleton, solved.positions, "tip").translation -
               direction)
                  .norm(),
              kRounding);
  }
}

TEST(FabrikReachTest, InTheHoleOfItsAnnulusItIsFoldedUp) {
  const auto chain = PlanarChain({0, 0, 0}, {0.2, 1.5, 0.1, 0.3});
  for (const Eigen::Vector3d& target :
       {Eigen::Vector3d(0.3, 0.4, 0), Eigen::Vector3d(0, 0, 0)}) {
    const Solved solved = Solve(chain, PositionGoalFor("tip", target),
                                Eigen::Vector4d(0.1, 0.2, 0.3, 0.4));
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
    EXPECT_NEAR(solved.report.position_errors_m[0], 0.9 - target.norm(),
                kRounding);
  }
}

TEST(FabrikReachTest, OutOfItsPlaneItComesAsNearAsThePlane) {
  const auto chain = EqualBones(10, BoneJoints::kHinges);
  const Solved solved = Solve(chain, PositionGoalFor("tip", {0.3, 0.4, 0.25}),
                              Eigen::VectorXd::Constant(10, 0.1));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kUnreachable);
  EXPECT_NEAR(solved.report.position_errors_m[0], 0.25, 1e-6);
}

// No sweep leaves the line by itself.
TEST_P(FabrikTest, StraightChainFindsTheTargetOnItsLine) {
  for (int count : {2, 3, 10, 30}) {
    const auto skeleton = EqualBones(count, GetParam());
    for (double x : {0.5, -0.5, 0.1, 0.0}) {
      const Goal goal = PositionGoalFor("tip", {x, 0, 0});
      const Solved solved = Solve(skeleton, goal, NeutralPositions(*skeleton));
      EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged)
          << count << " " << x;
      EXPECT_LE(OraclePositionError(*skeleton, goal, solved.positions),
                SolverOptions().position_tolerance_m);
    }
  }
}

// Two joints at one place have a bone of no length between them.
TEST(FabrikReachTest, BonesWithoutLengthDoNoHarm) {
  SkeletonBuilder builder;
  for (int i = 0; i < 6; ++i) {
    Joint joint;
    joint.id = std::string(1, static_cast<char>('a' + i));
    if (i > 0) joint.parent_id = std::string(1, static_cast<char>('a' + i - 1));
    joint.type = JointType::kSpherical;
    joint.parent_from_joint.translation.x() = i % 2 == 0 ? 0.3 : 0;
    builder.AddJoint(joint);
  }
  RigidTransform tip;
  tip.translation.x() = 0.3;
  const auto chain = builder.AddEndEffector({"tip", "f", tip}).Build().value();
  const Goal goal = PositionGoalFor("tip", {0.7, 0.4, 0.1});
  const Solved solved = Solve(chain, goal, NeutralPositions(*chain));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_LE(OraclePositionError(*chain, goal, solved.positions),
            SolverOptions().position_tolerance_m);
}

TEST_P(FabrikTest, SmallStepsOfTheTargetAreSmallStepsOfTheJoints) {
  Random random(3);
  const auto skeleton = RandomBones(random, GetParam(), 12);
  Eigen::VectorXd positions = RandomPose(random, *skeleton);
  const Eigen::Vector3d from =
      EffectorPose(*skeleton, positions, "tip").translation;
  const Solved solved = Solve(
      skeleton, PositionGoalFor("tip", from + Eigen::Vector3d(1e-3, 0, 0)),
      positions);
  Eigen::VectorXd change(skeleton->velocity_count());
  Difference(*skeleton, positions, solved.positions, change);
  EXPECT_LE(change.cwiseAbs().maxCoeff(), 0.2);
  EXPECT_NEAR(solved.report.change, change.norm(), kRounding);
}

TEST(FabrikReportTest, GoalOfWeightZeroIsOff) {
  const auto chain = EqualBones(5, BoneJoints::kHinges);
  Goal goal = PositionGoalFor("tip", {0.3, 0.4, 0});
  goal.weight = 0;
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(5, 0.1);
  const Solved solved = Solve(chain, goal, start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(solved.positions, start);
}

TEST(FabrikReportTest, CountsItsSweepsAndStopsWhenTold) {
  const auto chain = EqualBones(3, BoneJoints::kHinges);
  const IkProblem problem =
      IkProblem::Create(chain, {PositionGoalFor("tip", {0.98, 0.01, 0})})
          .value();
  SolverOptions options;
  options.position_tolerance_m = 1e-9;
  options.max_iterations = 1;
  Eigen::VectorXd positions = Eigen::Vector3d(0.5, 1, 1);
  SolveReport report;
  FabrikSolver solver;
  solver.Solve(problem, options, positions, report);
  EXPECT_EQ(report.outcome, SolveOutcome::kIterationLimit);
  EXPECT_EQ(report.iteration_count, kSweepsPerIteration);
  const StopCondition stop = {[](const void*) { return true; }, nullptr};
  positions = Eigen::Vector3d(0.5, 1, 1);
  solver.Solve(problem, options, positions, report, stop);
  EXPECT_EQ(report.outcome, SolveOutcome::kTimeLimit);
  EXPECT_EQ(report.iteration_count, 0);
}

std::string WhyNot(const std::shared_ptr<const Skeleton>& skeleton,
                   std::vector<Goal> goals) {
  return std::string(
      FabrikSolver::Check(IkProblem::Create(skeleton, std::move(goals)).value())
          .message());
}

TEST(FabrikCheckTest, SaysWhatDoesNotFit) {
  const auto chain = EqualBones(5, BoneJoints::kHinges);
  const Goal position = PositionGoalFor("tip", {0.3, 0.4, 0});
  EXPECT_EQ(WhyNot(chain, {position}), "");
  EXPECT_THAT(WhyNot(chain, {}), HasSubstr("method: fabrik: want one goal"));
  EXPECT_THAT(WhyNot(chain, {position, PositionGoalFor("j3", {0, 0, 0})}),
              HasSubstr("want one goal"));
  EXPECT_THAT(WhyNot(chain, {PoseGoalFor("tip", {})}),
              HasSubstr("want a position goal, along all axes"));
  Goal masked = position;
  std::get<PositionGoal>(masked.kind).axes.z = false;
  EXPECT_THAT(WhyNot(chain, {masked}), HasSubstr("along all axes"));
  EXPECT_THAT(WhyNot(PandaArm(), {PositionGoalFor("tip", {0.3, 0, 0.5})}),
              HasSubstr("method: fabrik: joint \"j0\": has limits"));
}

TEST(FabrikCheckTest, IsOneOfTheMethods) {
  const auto chain = EqualBones(5, BoneJoints::kHinges);
  const IkProblem problem =
      IkProblem::Create(chain, {PositionGoalFor("tip", {0.3, 0.4, 0})}).value();
  SolverOptions options;
  options.method = SolverMethod::kFabrik;
  EXPECT_TRUE(IkSolver::Check(problem, options).ok());
  Eigen::VectorXd positions = Eigen::VectorXd::Constant(5, 0.1);
  SolveReport report;
  IkSolver().Solve(problem, options, SolveStart::kCold, positions, report);
  EXPECT_EQ(report.method, SolverMethod::kFabrik);
  EXPECT_EQ(report.outcome, SolveOutcome::kConverged);

  const IkProblem arm =
      IkProblem::Create(PandaArm(), {PositionGoalFor("tip", {0.3, 0, 0.5})})
          .value();
  EXPECT_EQ(IkSolver::Check(arm, options).code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(FabrikRepeatTest, SameRequestSameBits) {
  Random random(4);
  FabrikSolver old;
  for (int i = 0; i < 20; ++i) {
    const auto skeleton =
        RandomBones(random, BoneJoints::kGimbals, 1 + UniformIndex(random, 20));
    const Goal goal = PositionGoalFor(
        "tip", EffectorPose(*skeleton, RandomPose(random, *skeleton), "tip")
                   .translation);
    const Eigen::VectorXd start = RandomPose(random, *skeleton);
    const Solved fresh = Solve(skeleton, goal, start);
    Solved again = {start, {}};
    old.Solve(IkProblem::Create(skeleton, {goal}).value(), {}, again.positions,
              again.report);
    EXPECT_EQ(fresh.positions, again.positions);
    EXPECT_EQ(fresh.report.iteration_count, again.report.iteration_count);
  }
}

}  // namespace
}  // namespace gelenk
