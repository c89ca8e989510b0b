#include "gelenk/kinematics/kinematic_tree.h"

#include <gtest/gtest.h>

#include <string>

#include "absl/strings/str_cat.h"

#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/kinematics/jacobian.h"
#include "tests/testing/matrix_kinematics_oracle.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::MatrixKinematicsOracle;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RandomTransform;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::UniformIndex;

using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Rounding of some 1e-16 a joint against frames that are up to tens of metres
// away, over the longest of our chains.
constexpr double kRounding = 1e-13;

class KinematicTreeTest : public ::testing::TestWithParam<InstructionSet> {
 protected:
  void ExpectFrames(const Skeleton& skeleton,
                    const Eigen::VectorXd& positions) const {
    KinematicFrames frames;
    KinematicTree(skeleton, GetParam()).Evaluate(positions, frames);
    WorldTransforms transforms;
    ForwardKinematics(skeleton, positions, transforms);
    const MatrixKinematicsOracle oracle(skeleton, positions);
    for (int i = 0; i < skeleton.joint_count(); ++i) {
      const Eigen::Matrix4d want = oracle.WorldFromJoint(skeleton.joint(i).id);
      const double size = 1 + want.topRightCorner<3, 1>().norm();
      EXPECT_LE((frames.rotation(i) - want.topLeftCorner<3, 3>()).norm(),
                kRounding);
      EXPECT_LE((frames.origin(i) - want.topRightCorner<3, 1>()).norm(),
                kRounding * size);
      EXPECT_LE((frames.rotation(i) - transforms[i].rotation.toRotationMatrix())
                    .norm(),
                kRounding);
      EXPECT_LE((frames.origin(i) - transforms[i].translation).norm(),
                kRounding * size);
    }
  }

  // The Jacobian of a joint's origin, made of nothing but frames and axes.
  Jacobian JacobianFromAxes(const Skeleton& skeleton,
                            const Eigen::VectorXd& positions,
                            const RigidTransform& world_from_skeleton,
                            int joint) const {
    const KinematicTree tree(skeleton, GetParam());
    KinematicFrames frames;
    tree.Evaluate(positions, world_from_skeleton, frames);
    Jacobian jacobian = Jacobian::Zero(6, skeleton.velocity_count());
    for (size_t a = 0; a < tree.axes().size(); ++a) {
      const MotionAxis& motion = tree.axes()[a];
      bool moves = false;
      for (int i = joint; i >= 0; i = skeleton.span(i).parent) {
        moves = moves || i == motion.joint;
      }
      if (!moves) continue;
      const Eigen::Vector3d axis =
          motion.multiplier * tree.WorldAxis(frames, static_cast<int>(a));
      if (!motion.rotation) {
        jacobian.col(motion.velocity).head<3>() += axis;
        continue;
      }
      jacobian.col(motion.velocity).head<3>() +=
          axis.cross(frames.origin(joint) - frames.origin(motion.joint));
      jacobian.col(motion.velocity).tail<3>() += axis;
    }
    return jacobian;
  }
};

INSTANTIATE_TEST_SUITE_P(
    EachLevel, KinematicTreeTest,
    ::testing::ValuesIn(SupportedInstructionSets()),
    [](const ::testing::TestParamInfo<InstructionSet>& info) {
      return std::string(InstructionSetName(info.param));
    });

TEST_P(KinematicTreeTest, AgreesOnRandomTrees) {
  Random random(1);
  SkeletonRecipe recipe;
  for (int tree = 0; tree < 200; ++tree) {
    recipe.joint_count = 1 + UniformIndex(random, 40);
    const auto skeleton = RandomSkeleton(random, recipe);
    ExpectFrames(*skeleton, RandomPose(random, *skeleton));
  }
}

TEST_P(KinematicTreeTest, AgreesOnEachTypeByItself) {
  Random random(2);
  SkeletonRecipe recipe;
  recipe.joint_count = 5;
  for (JointType type :
       {JointType::kFixed, JointType::kRevolute, JointType::kPrismatic,
        JointType::kSpherical, JointType::kPlanar, JointType::kFree}) {
    recipe.types = {type};
    for (int tree = 0; tree < 20; ++tree) {
      const auto skeleton = RandomSkeleton(random, recipe);
      ExpectFrames(*skeleton, RandomPose(random, *skeleton));
    }
  }
}

// Axes along those of the joint's frame are a case of their own.
TEST_P(KinematicTreeTest, AgreesOnAlignedAxesOfEitherSign) {
  Random random(3);
  for (JointType type :
       {JointType::kRevolute, JointType::kPrismatic, JointType::kPlanar}) {
    SkeletonBuilder builder;
    for (int i = 0; i < 12; ++i) {
      Joint joint;
      joint.id = absl::StrCat("j", i);
      if (i > 0) joint.parent_id = absl::StrCat("j", i - 1);
      joint.type = type;
      // The oracle knows no basis of a plane that faces the wrong way.
      const bool flipped = i >= 6 && type != JointType::kPlanar;
      joint.axis = (flipped ? -1 : 1) * Eigen::Vector3d::Unit(i % 3);
      joint.parent_from_joint = RandomTransform(random, 0.5);
      if (i > 9 && type != JointType::kPlanar) {
        joint.mimic = Mimic{absl::StrCat("j", i - 6), -1.5, 0.2};
      }
      builder.AddJoint(joint);
    }
    const auto skeleton = builder.Build().value();
    const Eigen::VectorXd positions = RandomPose(random, *skeleton);
    ExpectFrames(*skeleton, positions);
    WorldTransforms transforms;
    ForwardKinematics(*skeleton, positions, transforms);
    Jacobian want;
    ComputeJacobian(*skeleton, positions, transforms,
                    skeleton->FindEffector("j11").value(), want);
    const Jacobian got = JacobianFromAxes(*skeleton, positions, {}, 11);
    EXPECT_LE((got - want).norm(), kRounding * (1 + want.norm()));
  }
}

TEST_P(KinematicTreeTest, AxesMakeTheJacobianWhereverTheActorStands) {
  Random random(4);
  SkeletonRecipe recipe;
  for (int tree = 0; tree < 200; ++tree) {
    recipe.joint_count = 1 + UniformIndex(random, 25);
    const auto skeleton = RandomSkeleton(random, recipe);
    const Eigen::VectorXd positions = RandomPose(random, *skeleton);
    const RigidTransform world_from_skeleton = RandomTransform(random, 3);
    const int joint = UniformIndex(random, skeleton->joint_count());
    WorldTransforms transforms;
    ForwardKinematics(*skeleton, positions, world_from_skeleton, transforms);
    Jacobian want;
    ComputeJacobian(*skeleton, positions, transforms,
                    skeleton->FindEffector(skeleton->joint(joint).id).value(),
                    want);
    const Jacobian got =
        JacobianFromAxes(*skeleton, positions, world_from_skeleton, joint);
    ASSERT_EQ(got.cols(), want.cols());
    EXPECT_LE((got - want).norm(), kRounding * (1 + want.norm()));
  }
}

// On both sides of the bound of the vectorised sine; an error of the reduction
// of the angle would grow with it.
TEST_P(KinematicTreeTest, TakesAngleOfAnySize) {
  Random random(5);
  SkeletonRecipe recipe;
  recipe.types = {JointType::kRevolute};
  recipe.mimicking = 0;
  recipe.joint_count = 9;
  for (double size : {1e-9, 1.0, 1e3, 0.99e5, 1.01e5, 1e9}) {
    const auto skeleton = RandomSkeleton(random, recipe);
    Eigen::VectorXd positions(9);
    for (double& angle : positions) angle = Uniform(random, -size, size);
    positions[UniformIndex(random, 9)] = size;
    ExpectFrames(*skeleton, positions);
  }
}

TEST_P(KinematicTreeTest, ReusesFramesOfAnotherTree) {
  Random random(6);
  SkeletonRecipe recipe;
  KinematicFrames frames;
  for (int joint_count : {20, 3, 12}) {
    recipe.joint_count = joint_count;
    const auto skeleton = RandomSkeleton(random, recipe);
    const Eigen::VectorXd positions = RandomPose(random, *skeleton);
    KinematicTree(*skeleton, GetParam()).Evaluate(positions, frames);
    WorldTransforms transforms;
    ForwardKinematics(*skeleton, positions, transforms);
    EXPECT_LE(
        (frames.origin(joint_count - 1) - transforms.back().translation).norm(),
        10 * kRounding);
  }
}

TEST_P(KinematicTreeTest, SkeletonWithoutFreedom) {
  Joint root;
  root.id = "root";
  root.parent_from_joint.translation = {1, 2, 3};
  const auto skeleton = SkeletonBuilder().AddJoint(root).Build().value();
  const KinematicTree tree(*skeleton, GetParam());
  KinematicFrames frames;
  tree.Evaluate(Eigen::VectorXd(), frames);
  EXPECT_EQ(frames.origin(0), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(tree.axes().empty());
}

}  // namespace
}  // namespace gelenk
