#include "gelenk/kinematics/forward_kinematics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/testing/example_skeletons.h"
#include "tests/testing/matrix_kinematics_oracle.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::MatrixKinematicsOracle;
using ::gelenk::testing::MatrixOf;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RandomTransform;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::UniformIndex;

// Of a frame's size: rounding errors of 1e-16 a joint, piled up over the
// longest of our chains.
constexpr double kRelativeRounding = 1e-12;

void ExpectFramesOfOracle(const Skeleton& skeleton,
                          const Eigen::VectorXd& positions) {
  WorldTransforms world_from_joints;
  ForwardKinematics(skeleton, positions, world_from_joints);
  ASSERT_EQ(world_from_joints.size(), size_t(skeleton.joint_count()));
  const MatrixKinematicsOracle oracle(skeleton, positions);
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const Eigen::Matrix4d want = oracle.WorldFromJoint(skeleton.joint(i).id);
    EXPECT_TRUE(
        MatrixOf(world_from_joints[i]).isApprox(want, kRelativeRounding))
        << skeleton.joint(i).id;
  }
}

TEST(ForwardKinematicsTest, AgreesWithMatricesOnRandomTrees) {
  Random random(1);
  SkeletonRecipe recipe;
  for (int tree = 0; tree < 300; ++tree) {
    recipe.joint_count = 1 + UniformIndex(random, 40);
    const auto skeleton = RandomSkeleton(random, recipe);
    ExpectFramesOfOracle(*skeleton, RandomPose(random, *skeleton));
  }
}

class ForwardKinematicsOfTypeTest : public ::testing::TestWithParam<JointType> {
};

TEST_P(ForwardKinematicsOfTypeTest, AgreesWithMatrices) {
  Random random(2);
  SkeletonRecipe recipe;
  recipe.types = {GetParam()};
  recipe.joint_count = 5;
  for (int tree = 0; tree < 20; ++tree) {
    const auto skeleton = RandomSkeleton(random, recipe);
    ExpectFramesOfOracle(*skeleton, RandomPose(random, *skeleton));
  }
}

INSTANTIATE_TEST_SUITE_P(
    EachType, ForwardKinematicsOfTypeTest,
    ::testing::Values(JointType::kFixed, JointType::kRevolute,
                      JointType::kPrismatic, JointType::kSpherical,
                      JointType::kPlanar, JointType::kFree));

TEST(ForwardKinematicsTest, StandsWhereTheActorStands) {
  Random random(3);
  const auto skeleton = RandomSkeleton(random);
  const Eigen::VectorXd positions = RandomPose(random, *skeleton);
  const RigidTransform world_from_skeleton = RandomTransform(random, 10);
  WorldTransforms at_origin;
  WorldTransforms moved;
  ForwardKinematics(*skeleton, positions, at_origin);
  ForwardKinematics(*skeleton, positions, world_from_skeleton, moved);
  for (int i = 0; i < skeleton->joint_count(); ++i) {
    EXPECT_TRUE(MatrixOf(moved[i]).isApprox(
        MatrixOf(world_from_skeleton) * MatrixOf(at_origin[i]),
        kRelativeRounding));
  }
}

TEST(ForwardKinematicsTest, ReusesTransformsOfAnotherSkeleton) {
  Random random(4);
  SkeletonRecipe recipe;
  WorldTransforms world_from_joints;
  for (int joint_count : {20, 3, 12}) {
    recipe.joint_count = joint_count;
    const auto skeleton = RandomSkeleton(random, recipe);
    ForwardKinematics(*skeleton, RandomPose(random, *skeleton),
                      world_from_joints);
    EXPECT_EQ(world_from_joints.size(), size_t(joint_count));
  }
}

// Link lengths 4, 6, 2 at relative angles 60, 270, 60 degrees.
TEST(ForwardKinematicsTest, PlanarExampleComesOut) {
  constexpr double kDegree = M_PI / 180;
  const double root3 = std::sqrt(3);
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {4, 6, 2});
  const Eigen::Vector3d angles = Eigen::Vector3d(60, 270, 60) * kDegree;
  WorldTransforms world_from_joints;
  ForwardKinematics(*chain, angles, world_from_joints);
  const EffectorFrame tip = chain->FindEffector("tip").value();
  const Eigen::Vector3d world_tip =
      (world_from_joints[tip.joint] * tip.joint_from_effector).translation;
  const Eigen::Vector3d want[] = {{0, 0, 0},
                                  {2, 2 * root3, 0},
                                  {2 + 3 * root3, 2 * root3 - 3, 0},
                                  {2 + 4 * root3, 2 * root3 - 2, 0}};
  for (int i = 0; i < 3; ++i) {
    EXPECT_LE((world_from_joints[i].translation - want[i]).norm(),
              10 * kRelativeRounding);
  }
  EXPECT_LE((world_tip - want[3]).norm(), 10 * kRelativeRounding);
}

TEST(ForwardKinematicsTest, PlanarChainMayStandAnywhere) {
  const auto chain = PlanarChain({50, 400, 0}, {150, 200, 100});
  WorldTransforms world_from_joints;
  ForwardKinematics(*chain, Eigen::Vector3d(0.6, 1.0, -0.7), world_from_joints);
  const Eigen::Vector3d world_tip =
      world_from_joints[2] * Eigen::Vector3d(100, 0, 0);
  EXPECT_NEAR(world_tip.x(), 230.1214346032604, 450 * kRelativeRounding);
  EXPECT_NEAR(world_tip.y(), 762.9437825803047, 450 * kRelativeRounding);
}

TEST(ForwardKinematicsTest, SkeletonWithoutFreedom) {
  Joint root;
  root.id = "root";
  root.parent_from_joint.translation = {1, 2, 3};
  const auto skeleton = SkeletonBuilder().AddJoint(root).Build().value();
  WorldTransforms world_from_joints;
  ForwardKinematics(*skeleton, Eigen::VectorXd(), world_from_joints);
  EXPECT_EQ(world_from_joints[0].translation, Eigen::Vector3d(1, 2, 3));
}

TEST(JointMotionTest, PlanarMovesInItsBasis) {
  Joint joint;
  joint.id = "root";
  joint.type = JointType::kPlanar;
  joint.axis = Eigen::Vector3d(0.6, 0, 0.8);
  const auto skeleton = SkeletonBuilder().AddJoint(joint).Build().value();
  const RigidTransform motion =
      JointMotion(*skeleton, 0, Eigen::Vector3d(2, 3, 0));
  // Z tilts towards X about Y by acos(0.8): X dips, Y stays.
  EXPECT_LE((motion.translation - Eigen::Vector3d(1.6, 3, -1.2)).norm(),
            kRelativeRounding);
}

}  // namespace
}  // namespace gelenk
