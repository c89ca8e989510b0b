#include "gelenk/kinematics/jacobian.h"

#include <gtest/gtest.h>

#include "tests/testing/example_skeletons.h"
#include "tests/testing/matrix_kinematics_oracle.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::MatrixKinematicsOracle;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::UniformIndex;

using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Central differences of a step h = 1e-5 err by h^2 times a third derivative
// (below 100 m or rad here: some columns drive several mimic joints at once)
// and by 1e-14 / h of rounding: 1e-8 and 1e-9. The bound leaves room.
constexpr double kStep = 1e-5;
constexpr double kDifferenceError = 1e-7;

Eigen::Matrix4d EffectorAfter(const Skeleton& skeleton,
                              const Eigen::VectorXd& positions, int column,
                              double step, absl::string_view id) {
  Eigen::VectorXd velocity = Eigen::VectorXd::Zero(skeleton.velocity_count());
  velocity[column] = step;
  Eigen::VectorXd moved(positions.size());
  Integrate(skeleton, positions, velocity, moved);
  return MatrixKinematicsOracle(skeleton, moved).WorldFromEndEffector(id);
}

// By the oracle, which knows nothing of Jacobians.
Jacobian DifferenceQuotients(const Skeleton& skeleton,
                             const Eigen::VectorXd& positions,
                             absl::string_view id) {
  Jacobian jacobian(6, skeleton.velocity_count());
  for (int column = 0; column < skeleton.velocity_count(); ++column) {
    const Eigen::Matrix4d ahead =
        EffectorAfter(skeleton, positions, column, kStep, id);
    const Eigen::Matrix4d behind =
        EffectorAfter(skeleton, positions, column, -kStep, id);
    // Of a small rotation, the skew part is the rotation vector.
    const Eigen::Matrix3d turn =
        ahead.topLeftCorner<3, 3>() * behind.topLeftCorner<3, 3>().transpose();
    const Eigen::Vector3d twice(turn(2, 1) - turn(1, 2),
                                turn(0, 2) - turn(2, 0),
                                turn(1, 0) - turn(0, 1));
    jacobian.col(column).head<3>() =
        (ahead - behind).col(3).head<3>() / (2 * kStep);
    jacobian.col(column).tail<3>() = twice / (4 * kStep);
  }
  return jacobian;
}

Jacobian ComputedJacobian(const Skeleton& skeleton,
                          const Eigen::VectorXd& positions,
                          absl::string_view id) {
  WorldTransforms world_from_joints;
  ForwardKinematics(skeleton, positions, world_from_joints);
  Jacobian jacobian;
  ComputeJacobian(skeleton, positions, world_from_joints,
                  skeleton.FindEffector(id).value(), jacobian);
  return jacobian;
}

void ExpectDifferenceQuotients(const Skeleton& skeleton,
                               const Eigen::VectorXd& positions,
                               absl::string_view id) {
  const Jacobian got = ComputedJacobian(skeleton, positions, id);
  const Jacobian want = DifferenceQuotients(skeleton, positions, id);
  ASSERT_EQ(got.cols(), want.cols());
  if (got.cols() == 0) return;
  EXPECT_LE((got - want).cwiseAbs().maxCoeff(), kDifferenceError) << id;
}

TEST(JacobianTest, IsTheDerivativeOnRandomTrees) {
  Random random(1);
  SkeletonRecipe recipe;
  for (int tree = 0; tree < 100; ++tree) {
    recipe.joint_count = 1 + UniformIndex(random, 15);
    const auto skeleton = RandomSkeleton(random, recipe);
    const Eigen::VectorXd positions = RandomPose(random, *skeleton);
    for (const EndEffector& effector : skeleton->end_effectors()) {
      ExpectDifferenceQuotients(*skeleton, positions, effector.id);
    }
    const int joint = UniformIndex(random, skeleton->joint_count());
    ExpectDifferenceQuotients(*skeleton, positions, skeleton->joint(joint).id);
  }
}

TEST(JacobianTest, IsTheDerivativeWithManyMimics) {
  Random random(2);
  SkeletonRecipe recipe;
  recipe.types = {JointType::kRevolute, JointType::kPrismatic};
  recipe.mimicking = 0.6;
  recipe.branching = 0.15;
  recipe.joint_count = 8;
  for (int tree = 0; tree < 50; ++tree) {
    const auto skeleton = RandomSkeleton(random, recipe);
    const Eigen::VectorXd positions = RandomPose(random, *skeleton);
    for (const EndEffector& effector : skeleton->end_effectors()) {
      ExpectDifferenceQuotients(*skeleton, positions, effector.id);
    }
  }
}

// A joint may follow one that is not its ancestor.
TEST(JacobianTest, MimicOnAnotherBranch) {
  Joint root;
  root.id = "root";
  Joint finger;
  finger.id = "finger";
  finger.parent_id = "root";
  finger.type = JointType::kRevolute;
  finger.parent_from_joint.translation = {0, 0.1, 0};
  Joint other = finger;
  other.id = "other";
  other.mimic = Mimic{"finger", -2, 0.3};
  RigidTransform tip;
  tip.translation = {0, 0.05, 0};
  const auto hand = SkeletonBuilder()
                        .AddJoint(root)
                        .AddJoint(finger)
                        .AddJoint(other)
                        .AddEndEffector({"tip", "other", tip})
                        .Build()
                        .value();
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.4);
  ExpectDifferenceQuotients(*hand, q, "tip");
  EXPECT_EQ(ComputedJacobian(*hand, q, "tip").col(0).tail<3>(),
            Eigen::Vector3d(-2, 0, 0));
}

TEST(JacobianTest, ColumnsOfOtherBranchesAreZero) {
  Random random(3);
  SkeletonRecipe recipe;
  recipe.mimicking = 0;
  recipe.branching = 1;
  const auto skeleton = RandomSkeleton(random, recipe);
  const Eigen::VectorXd positions = RandomPose(random, *skeleton);
  const int joint = skeleton->joint_count() - 1;
  Jacobian rest =
      ComputedJacobian(*skeleton, positions, skeleton->joint(joint).id);
  for (int i = joint; i >= 0; i = skeleton->span(i).parent) {
    const int count = VelocityCount(skeleton->joint(i).type);
    if (count == 0) continue;
    rest.middleCols(skeleton->span(i).velocity_offset, count).setZero();
  }
  EXPECT_TRUE(rest.isZero(0));
}

TEST(JacobianTest, PlanarExampleComesOut) {
  const auto chain =
      ::gelenk::testing::PlanarChain({50, 400, 0}, {150, 200, 100});
  const Jacobian jacobian =
      ComputedJacobian(*chain, Eigen::Vector3d(0.6, 1.0, -0.7), "tip");
  Eigen::Matrix<double, 2, 3> want;
  want << -362.94378258030474, -278.24741157104944, -78.33269096274842,
      180.1214346032604, 56.32109236680867, 62.16099682706644;
  // Printed with 16 digits.
  EXPECT_TRUE(jacobian.topRows<2>().isApprox(want, 1e-14));
  EXPECT_TRUE(jacobian.row(5).isOnes(1e-14));
}

}  // namespace
}  // namespace gelenk
