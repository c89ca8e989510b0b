// Inverse kinematics of forward kinematics: targets taken from random poses
// inside the limits can be reached, and are. Answers are checked by the matrix
// oracle and by the limits, never by the solver's own report.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "gelenk/ik/levenberg_marquardt_solver.h"
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
using ::gelenk::testing::PoseGoalsAt;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RotationGoalFor;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::StartNear;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::UniformIndex;

// What the oracle and the solver may disagree on.
constexpr double kRounding = 1e-9;
// By how much an answer may break a limit.
constexpr double kLimitExcess = 1e-9;
// A stream's frame: each degree of freedom this near to its answer.
constexpr double kWarmDistance = 0.1;
// Of 1000 warm starts at most one may fail.
constexpr double kWarmRate = 0.999;

// Solves and counts; an answer that claims to be there must be.
class Tally {
 public:
  void Solve(const std::shared_ptr<const Skeleton>& skeleton,
             const std::vector<Goal>& goals, SolveStart from,
             const Eigen::VectorXd& start) {
    const IkProblem problem = IkProblem::Create(skeleton, goals).value();
    Eigen::VectorXd positions = start;
    SolveReport report;
    solver_.Solve(problem, options_, from, positions, report);
    ++solved_;
    EXPECT_LE(LimitExcess(*skeleton, positions, nullptr), kLimitExcess);
    EXPECT_TRUE(CheckPositions(*skeleton, positions).ok());
    if (report.outcome != SolveOutcome::kConverged) return;
    ++converged_;
    for (size_t i = 0; i < goals.size(); ++i) {
      const double position =
          OraclePositionError(*skeleton, goals[i], positions);
      const double rotation =
          OracleRotationError(*skeleton, goals[i], positions);
      EXPECT_LE(position, options_.position_tolerance_m + kRounding);
      EXPECT_LE(rotation, options_.rotation_tolerance_rad + kRounding);
      EXPECT_NEAR(report.position_errors_m[i], position, kRounding);
      EXPECT_NEAR(report.rotation_errors_rad[i], rotation, 1e-7);
    }
  }

  double Rate() const { return double(converged_) / solved_; }

 private:
  SolverOptions options_;
  LevenbergMarquardtSolver solver_;
  int solved_ = 0;
  int converged_ = 0;
};

void SolveWarm(Random& random, const std::shared_ptr<const Skeleton>& skeleton,
               Tally& tally) {
  const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *skeleton);
  tally.Solve(skeleton, PoseGoalsAt(*skeleton, truth), SolveStart::kWarm,
              StartNear(random, *skeleton, truth, kWarmDistance));
}

TEST(ReachTest, WarmOnRandomTrees) {
  Random random(1);
  Tally tally;
  SkeletonRecipe recipe;
  for (int i = 0; i < 1000; ++i) {
    recipe.joint_count = 1 + UniformIndex(random, 25);
    SolveWarm(random, RandomSkeleton(random, recipe), tally);
  }
  EXPECT_GE(tally.Rate(), kWarmRate);
}

TEST(ReachTest, WarmOnRandomTreesOfHingesWithMimics) {
  Random random(2);
  Tally tally;
  SkeletonRecipe recipe;
  recipe.types = {JointType::kRevolute, JointType::kRevolute,
                  JointType::kPrismatic};
  recipe.mimicking = 0.4;
  for (int i = 0; i < 1000; ++i) {
    recipe.joint_count = 1 + UniformIndex(random, 25);
    SolveWarm(random, RandomSkeleton(random, recipe), tally);
  }
  EXPECT_GE(tally.Rate(), kWarmRate);
}

TEST(ReachTest, WarmOnRandomTreesOfLimitedBallJoints) {
  Random random(3);
  Tally tally;
  SkeletonRecipe recipe;
  recipe.types = {JointType::kSpherical, JointType::kRevolute};
  recipe.limited = 1;
  for (int i = 0; i < 1000; ++i) {
    recipe.joint_count = 1 + UniformIndex(random, 15);
    SolveWarm(random, RandomSkeleton(random, recipe), tally);
  }
  EXPECT_GE(tally.Rate(), kWarmRate);
}

// Goals of every kind on joints and end effectors, with weights.
TEST(ReachTest, WarmWithMixedGoals) {
  Random random(4);
  Tally tally;
  for (int i = 0; i < 1000; ++i) {
    const auto skeleton = RandomSkeleton(random);
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *skeleton);
    std::vector<Goal> goals = PoseGoalsAt(*skeleton, truth);
    const int a = UniformIndex(random, skeleton->joint_count());
    const int b = UniformIndex(random, skeleton->joint_count());
    const std::string& first = skeleton->joint(a).id;
    const std::string& second = skeleton->joint(b).id;
    goals.push_back(PositionGoalFor(
        first, EffectorPose(*skeleton, truth, first).translation));
    goals.push_back(RotationGoalFor(
        second, EffectorPose(*skeleton, truth, second).rotation));
    goals.back().id = "rotation";
    for (Goal& goal : goals) goal.weight = Uniform(random, 0.3, 3);
    tally.Solve(skeleton, goals, SolveStart::kWarm,
                StartNear(random, *skeleton, truth, kWarmDistance));
  }
  EXPECT_GE(tally.Rate(), kWarmRate);
}

TEST(ReachTest, WarmOnASevenAxisArm) {
  Random random(5);
  Tally tally;
  const auto panda = PandaArm();
  for (int i = 0; i < 3000; ++i) SolveWarm(random, panda, tally);
  EXPECT_GE(tally.Rate(), kWarmRate);
}

TEST(ReachTest, ColdOnASevenAxisArm) {
  Random random(6);
  Tally tally;
  const auto panda = PandaArm();
  Eigen::VectorXd middle(7);
  for (int j = 0; j < 7; ++j) {
    const JointLimits& limits = panda->joint(j).limits;
    middle[j] = 0.5 * (limits.lower[0] + limits.upper[0]);
  }
  for (int i = 0; i < 500; ++i) {
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *panda);
    tally.Solve(panda, PoseGoalsAt(*panda, truth), SolveStart::kCold, middle);
  }
  EXPECT_GE(tally.Rate(), 0.998);
}

// From anywhere on a tree with several effectors a restart may still miss.
TEST(ReachTest, ColdOnRandomTrees) {
  Random random(7);
  Tally tally;
  SkeletonRecipe recipe;
  recipe.types = {JointType::kRevolute, JointType::kSpherical,
                  JointType::kFixed};
  recipe.branching = 0.1;
  recipe.joint_count = 8;
  for (int i = 0; i < 200; ++i) {
    const auto skeleton = RandomSkeleton(random, recipe);
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *skeleton);
    tally.Solve(skeleton, PoseGoalsAt(*skeleton, truth), SolveStart::kCold,
                NeutralPositions(*skeleton));
  }
  EXPECT_GE(tally.Rate(), 0.9);
}

}  // namespace
}  // namespace gelenk
