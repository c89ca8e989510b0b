// Arms whose joints mimic others are none for the kernels of arms; they are
// solved as often all the same, and warm as near.
#include <gtest/gtest.h>

#include <memory>

#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/ik/solve_arm.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::OraclePositionError;
using ::gelenk::testing::OracleRotationError;
using ::gelenk::testing::PoseGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::StartNear;

// m and rad.
constexpr double kFine = 1e-5;
constexpr double kRounding = 1e-9;

// 7 to 10 joints; one in five follows another.
std::shared_ptr<const Skeleton> MimicArm(Random& random) {
  testing::SkeletonRecipe recipe;
  recipe.types = {JointType::kRevolute, JointType::kRevolute,
                  JointType::kRevolute, JointType::kPrismatic};
  recipe.joint_count = 7 + testing::UniformIndex(random, 4);
  recipe.branching = 0;
  recipe.frozen = 0;
  return RandomSkeleton(random, recipe);
}

struct Tally {
  int solved = 0;
  int jumps = 0;
};

// As many arms, each in reach of its target.
Tally SolveMany(SolveStart from, int count, uint64_t seed) {
  Random random(seed);
  SolverOptions options;
  options.position_tolerance_m = kFine;
  options.rotation_tolerance_rad = kFine;
  LevenbergMarquardtSolver solver;
  SolveReport report;
  Tally tally;
  for (int i = 0; i < count; ++i) {
    const auto arm = MimicArm(random);
    const Eigen::VectorXd truth = RandomPoseWithinLimits(random, *arm);
    const Goal goal = PoseGoalFor("e0", EffectorPose(*arm, truth, "e0"));
    const IkProblem problem = IkProblem::Create(arm, {goal}).value();
    const Eigen::VectorXd start = from == SolveStart::kWarm
                                      ? StartNear(random, *arm, truth, 0.1)
                                      : RandomPoseWithinLimits(random, *arm);
    Eigen::VectorXd positions = start;
    solver.Solve(problem, options, from, positions, report);
    tally.jumps += (positions - start).cwiseAbs().maxCoeff() > kArmJump;
    if (report.outcome != SolveOutcome::kConverged) continue;
    ++tally.solved;
    EXPECT_LE(OraclePositionError(*arm, goal, positions), kFine + kRounding);
    EXPECT_LE(OracleRotationError(*arm, goal, positions), kFine + kRounding);
    EXPECT_LE(LimitExcess(*arm, positions, nullptr), kRounding);
  }
  return tally;
}

TEST(MimicArmTest, ColdTargetsAreMet) {
  EXPECT_GE(SolveMany(SolveStart::kCold, 600, 1).solved, 599);
}

TEST(MimicArmTest, WarmTargetsAreMetNearby) {
  const Tally tally = SolveMany(SolveStart::kWarm, 2000, 2);
  // All but those from nearly singular poses.
  EXPECT_GE(tally.solved, 1998);
  EXPECT_LE(tally.jumps, 4);
}

}  // namespace
}  // namespace gelenk
