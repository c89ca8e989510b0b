#include "gelenk/ik/ik_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/time/time.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::OraclePositionError;
using ::gelenk::testing::PandaArm;
using ::gelenk::testing::PoseGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::StartNear;
using ::testing::ElementsAre;

// An arm, a pose that it can take, and a start near it.
class IkSolverTest : public ::testing::Test {
 protected:
  IkSolverTest() {
    Random random(1);
    const Eigen::VectorXd pose = RandomPoseWithinLimits(random, *skeleton_);
    start_ = StartNear(random, *skeleton_, pose, 0.3);
    problem_ = std::make_unique<IkProblem>(
        IkProblem::Create(
            skeleton_,
            {PoseGoalFor("tip", EffectorPose(*skeleton_, pose, "tip"))})
            .value());
  }

  std::shared_ptr<const Skeleton> skeleton_ = PandaArm();
  std::unique_ptr<IkProblem> problem_;
  Eigen::VectorXd start_;
};

TEST_F(IkSolverTest, UnaskedItSolvesByLevenbergMarquardt) {
  EXPECT_TRUE(IkSolver::Check(*problem_, {}).ok());
  IkSolver solver;
  Eigen::VectorXd positions = start_;
  SolveReport report;
  solver.Solve(*problem_, {}, SolveStart::kWarm, positions, report);
  EXPECT_EQ(report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(report.method, SolverMethod::kLevenbergMarquardt);

  LevenbergMarquardtSolver alone;
  Eigen::VectorXd expected = start_;
  alone.Solve(*problem_, {}, SolveStart::kWarm, expected, report);
  EXPECT_EQ(positions, expected);
}

// A clock that a test turns: each look at it takes a second.
double fake_seconds = 0;
absl::Duration FakeClock() { return absl::Seconds(fake_seconds++); }

TEST_F(IkSolverTest, StopsAtItsTimeLimit) {
  IkSolver solver(BestInstructionSet(), &FakeClock);
  SolverOptions options;
  options.time_limit = absl::Seconds(2.5);
  Eigen::VectorXd positions = start_;
  SolveReport report;
  solver.Solve(*problem_, options, SolveStart::kCold, positions, report);
  EXPECT_EQ(report.outcome, SolveOutcome::kTimeLimit);
  // Asked before each of the first three steps, and told to stop at the third.
  EXPECT_EQ(report.iteration_count, 2);
  EXPECT_EQ(report.restart_count, 0);
  // The pose is the one so far, and its errors are told.
  EXPECT_NE(positions, start_);
  EXPECT_NEAR(report.position_errors_m[0],
              OraclePositionError(*skeleton_, problem_->goals()[0], positions),
              1e-12);
}

TEST_F(IkSolverTest, ATimeLimitThatDoesNotStrikeChangesNothing) {
  IkSolver solver(BestInstructionSet(), &FakeClock);
  SolverOptions options;
  Eigen::VectorXd expected = start_;
  SolveReport report;
  solver.Solve(*problem_, options, SolveStart::kWarm, expected, report);
  options.time_limit = absl::Hours(1);
  Eigen::VectorXd positions = start_;
  solver.Solve(*problem_, options, SolveStart::kWarm, positions, report);
  EXPECT_EQ(report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(positions, expected);
}

TEST_F(IkSolverTest, WithoutAClockThereIsNoTimeLimit) {
  IkSolver solver;
  SolverOptions options;
  options.time_limit = absl::Nanoseconds(1);
  Eigen::VectorXd positions = start_;
  SolveReport report;
  solver.Solve(*problem_, options, SolveStart::kWarm, positions, report);
  EXPECT_EQ(report.outcome, SolveOutcome::kConverged);
}

TEST(SolverMethodTest, EachHasAName) {
  const SolverMethod all[] = {
      SolverMethod::kAuto,          SolverMethod::kTwoLink,
      SolverMethod::kNewton,        SolverMethod::kPseudoInverse,
      SolverMethod::kMinimalChange, SolverMethod::kLevenbergMarquardt,
      SolverMethod::kFabrik};
  std::vector<std::string> names;
  for (SolverMethod method : all) {
    names.emplace_back(SolverMethodName(method));
  }
  EXPECT_THAT(names,
              ElementsAre("auto", "two-link", "newton", "pseudo-inverse",
                          "minimal-change", "levenberg-marquardt", "fabrik"));
}

}  // namespace
}  // namespace gelenk
