// The slope and curvature of an arm's energy against finite differences.
#include "gelenk/ik/kernel/arm_curvature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/serial_arm.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::PoseGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::UniformIndex;
using ::gelenk::testing::WithProbability;

using Pose = kernel::ArmPose<2>;

// Central differences: the error of their third order, and rounding over their
// width.
constexpr double kWidth = 1e-5;
constexpr double kTolerance = 1e-7;

double EnergyOf(Pose& pose, const kernel::QuadFrame& wanted,
                const kernel::ArmSettings& settings) {
  pose.Forward();
  kernel::ArmResidual residual;
  kernel::FindResidual<6>(pose.tip, wanted, settings, residual);
  return residual.errors.energy;
}

kernel::ArmCurvature CurvatureOf(Pose& pose, const kernel::QuadFrame& wanted,
                                 const kernel::ArmSettings& settings) {
  pose.Forward();
  kernel::ArmCurvature curvature;
  kernel::FindCurvature(pose, wanted, settings, curvature);
  return curvature;
}

void ExpectDerivatives(const kernel::ArmLayout& arm,
                       const kernel::ArmSettings& settings,
                       const kernel::ArmTarget& target,
                       const kernel::ArmRow& q) {
  const kernel::QuadFrame wanted =
      kernel::FrameOf(target.world_rotation, target.world_translation);
  Pose pose(arm, settings, q);
  const kernel::ArmCurvature here = CurvatureOf(pose, wanted, settings);
  for (int i = 0; i < arm.joint_count; ++i) {
    pose.q = q;
    pose.q[i] += kWidth;
    const double energy_above = EnergyOf(pose, wanted, settings);
    const kernel::ArmCurvature above = CurvatureOf(pose, wanted, settings);
    pose.q[i] = q[i] - kWidth;
    const double energy_below = EnergyOf(pose, wanted, settings);
    const kernel::ArmCurvature below = CurvatureOf(pose, wanted, settings);
    EXPECT_NEAR((energy_above - energy_below) / (2 * kWidth), here.slope[i],
                kTolerance);
    for (int j = 0; j < arm.joint_count; ++j) {
      const double curvature = i < j ? here.hessian[j][i] : here.hessian[i][j];
      EXPECT_NEAR((above.slope[j] - below.slope[j]) / (2 * kWidth), curvature,
                  kTolerance)
          << i << " " << j;
    }
  }
}

TEST(ArmCurvatureTest, AgreesWithFiniteDifferences) {
  Random random(1);
  SkeletonRecipe recipe;
  recipe.types = {JointType::kRevolute, JointType::kRevolute,
                  JointType::kPrismatic};
  recipe.branching = 0;
  recipe.mimicking = 0;
  for (int i = 0; i < 100; ++i) {
    recipe.joint_count = 1 + UniformIndex(random, 9);
    const auto skeleton = RandomSkeleton(random, recipe);
    // Of a target far from the pose, so that every term counts.
    Goal goal = PoseGoalFor(
        "e0", EffectorPose(*skeleton, RandomPose(random, *skeleton), "e0"));
    PoseGoal& kind = std::get<PoseGoal>(goal.kind);
    kind.axes.y = WithProbability(random, 0.7);
    kind.rotation_scale_m_per_rad =
        WithProbability(random, 0.2) ? 0 : Uniform(random, 0.3, 2);
    const IkProblem problem = IkProblem::Create(skeleton, {goal}).value();
    const SerialArm& arm = *problem.arm();
    kernel::Settings settings = {};
    for (int k = 0; k < 3; ++k) settings.base_rotation[4 * k] = 1;
    const kernel::ArmRow free = {};
    settings.lower = settings.upper = free.values;
    kernel::ArmSettings arm_settings;
    kernel::ArmTarget target;
    arm.Prepare(settings, problem.targets()[0], arm_settings);
    arm.Prepare(problem.targets()[0], target);
    kernel::ArmRow q;
    arm.Gather(RandomPose(random, *skeleton), q);
    ExpectDerivatives(arm.layout(), arm_settings, target, q);
  }
}

}  // namespace
}  // namespace gelenk
