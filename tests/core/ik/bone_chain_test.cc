#include "gelenk/ik/bone_chain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/ik/goal.h"
#include "gelenk/ik/sparse_tree.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/core/ik/bone_chains.h"
#include "tests/testing/matrix_kinematics_oracle.h"
#include "tests/testing/random_pose.h"

namespace gelenk {
namespace {

using ::gelenk::testing::BoneJoints;
using ::gelenk::testing::EqualBones;
using ::gelenk::testing::MatrixKinematicsOracle;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomBones;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomTransform;
using ::gelenk::testing::UniformIndex;
using ::testing::HasSubstr;

// Rounding of some 1e-16 a joint, piled up over the longest of our chains.
constexpr double kRounding = 1e-12;

// The tasks of one position goal at "tip".
class TipTree {
 public:
  explicit TipTree(const std::shared_ptr<const Skeleton>& skeleton)
      : skeleton_(skeleton),
        tree_(*skeleton, std::vector<EffectorTask>{
                             TaskOf(*skeleton, PositionGoal{"tip"})}) {}

  absl::StatusOr<BoneChain> Bones() const {
    return BoneChain::Of(*skeleton_, tree_.Layout(), tree_.joints_of_nodes());
  }

 private:
  std::shared_ptr<const Skeleton> skeleton_;
  SparseTree tree_;
};

int JointsPerBone(BoneJoints joints) {
  return joints == BoneJoints::kGimbals ? 3 : 1;
}

// Where the pivots and the tip are, by the oracle, with the skeleton moved.
std::vector<Eigen::Vector3d> OraclePoints(
    const Skeleton& skeleton, const Eigen::VectorXd& positions,
    const RigidTransform& world_from_skeleton, int joints_per_bone) {
  const MatrixKinematicsOracle oracle(skeleton, positions);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < skeleton.joint_count(); i += joints_per_bone) {
    points.push_back(world_from_skeleton *
                     Eigen::Vector3d(oracle.WorldFromJoint(skeleton.joint(i).id)
                                         .topRightCorner<3, 1>()));
  }
  points.push_back(
      world_from_skeleton *
      Eigen::Vector3d(
          oracle.WorldFromEndEffector("tip").topRightCorner<3, 1>()));
  return points;
}

class BoneChainTest : public ::testing::TestWithParam<BoneJoints> {};

INSTANTIATE_TEST_SUITE_P(EachKind, BoneChainTest,
                         ::testing::Values(BoneJoints::kHinges,
                                           BoneJoints::kSpherical,
                                           BoneJoints::kGimbals));

TEST_P(BoneChainTest, PointsAreThoseOfForwardKinematics) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const auto skeleton =
        RandomBones(random, GetParam(), 1 + UniformIndex(random, 30));
    const BoneChain bones = TipTree(skeleton).Bones().value();
    const Eigen::VectorXd positions = RandomPose(random, *skeleton);
    const RigidTransform base = RandomTransform(random, 1);
    BonePose pose;
    bones.ComputePose(positions, base, pose);
    const std::vector<Eigen::Vector3d> want =
        OraclePoints(*skeleton, positions, base, JointsPerBone(GetParam()));
    ASSERT_EQ(pose.points.size(), want.size());
    // In a plane, what the bones have across it is left out.
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    if (GetParam() == BoneJoints::kHinges) {
      normal = base.rotation * (skeleton->joint(0).parent_from_joint.rotation *
                                skeleton->joint(0).axis);
    }
    for (size_t k = 0; k < want.size(); ++k) {
      const Eigen::Vector3d miss = pose.points[k] - want[k];
      EXPECT_LE((miss - miss.dot(normal) * normal).norm(), kRounding);
      EXPECT_LE(std::abs((pose.points[k] - pose.points[0]).dot(normal)),
                kRounding);
    }
    // Nothing turns when nothing has moved, and the tip is where it is.
    Eigen::VectorXd followed = positions;
    const Eigen::Vector3d tip = bones.Follow(pose, base, followed);
    EXPECT_LE((tip - want.back()).norm(), kRounding);
    EXPECT_LE((followed - positions).cwiseAbs().maxCoeff(), 1e-7);
  }
}

TEST_P(BoneChainTest, JointsFollowThePoints) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const int count = 1 + UniformIndex(random, 30);
    const auto skeleton = RandomBones(random, GetParam(), count);
    const BoneChain bones = TipTree(skeleton).Bones().value();
    const Eigen::VectorXd start = RandomPose(random, *skeleton);
    const RigidTransform base = RandomTransform(random, 1);
    BonePose pose;
    bones.ComputePose(start, base, pose);
    // Any other pose's points are possible ones.
    BonePose other;
    bones.ComputePose(RandomPose(random, *skeleton), base, other);
    pose.points = other.points;
    Eigen::VectorXd positions = start;
    const Eigen::Vector3d tip = bones.Follow(pose, base, positions);

    EXPECT_TRUE(CheckPositions(*skeleton, positions).ok());
    BonePose reached;
    bones.ComputePose(positions, base, reached);
    for (int k = 0; k <= count; ++k) {
      EXPECT_LE((reached.points[k] - other.points[k]).norm(), kRounding);
    }
    const std::vector<Eigen::Vector3d> want =
        OraclePoints(*skeleton, positions, base, JointsPerBone(GetParam()));
    EXPECT_LE((tip - want.back()).norm(), kRounding);
    if (GetParam() != BoneJoints::kSpherical) {
      EXPECT_LE((positions - start).cwiseAbs().maxCoeff(), M_PI + kRounding);
    }
  }
}

// The turn of each joint has no part about its own bone.
TEST(BoneChainTwistTest, SphericalJointsDoNotTwist) {
  Random random(3);
  const auto skeleton = RandomBones(random, BoneJoints::kSpherical, 10);
  const BoneChain bones = TipTree(skeleton).Bones().value();
  const Eigen::VectorXd start = RandomPose(random, *skeleton);
  BonePose pose;
  bones.ComputePose(RandomPose(random, *skeleton), {}, pose);
  const std::vector<Eigen::Vector3d> points = pose.points;
  bones.ComputePose(start, {}, pose);
  pose.points = points;
  Eigen::VectorXd positions = start;
  bones.Follow(pose, {}, positions);
  for (int k = 0; k < 10; ++k) {
    const Eigen::Vector3d bone =
        k < 9
            ? skeleton->joint(k + 1).parent_from_joint.translation
            : skeleton->end_effectors()[0].joint_from_end_effector.translation;
    const Eigen::Quaterniond turn =
        QuaternionXyzw(start.data() + 4 * k).conjugate() *
        QuaternionXyzw(positions.data() + 4 * k);
    EXPECT_LE(std::abs(turn.vec().dot(bone.normalized())), kRounding);
  }
}

// A gimbal that points along its first axis, and one a hair beside it.
TEST(BoneChainGimbalTest, PassesThroughItsLock) {
  const auto skeleton = EqualBones(1, BoneJoints::kGimbals);
  const BoneChain bones = TipTree(skeleton).Bones().value();
  for (double beside : {0.0, 1e-12, 1e-7, 1e-3}) {
    for (double side : {1.0, -1.0}) {
      Eigen::VectorXd positions = Eigen::Vector3d(0.3, -0.4, 0.2);
      BonePose pose;
      bones.ComputePose(positions, {}, pose);
      const Eigen::Vector3d to =
          Eigen::Vector3d(beside, 2 * beside, side).normalized();
      pose.points[1] = to;
      const Eigen::Vector3d tip = bones.Follow(pose, {}, positions);
      EXPECT_LE((tip - to).norm(), kRounding);
      EXPECT_LE((OraclePoints(*skeleton, positions, {}, 3)[1] - to).norm(),
                1e-8)
          << beside;
    }
  }
}

TEST(BoneChainRangeTest, AnglesStayInARangeOfAWholeTurn) {
  Random random(4);
  for (double lower : {-M_PI, 0.0, -5.0}) {
    JointLimits limits;
    limits.lower = {lower};
    limits.upper = {lower + 2 * M_PI};
    for (BoneJoints joints : {BoneJoints::kHinges, BoneJoints::kGimbals}) {
      const auto skeleton = RandomBones(random, joints, 20, limits);
      const BoneChain bones = TipTree(skeleton).Bones().value();
      BonePose pose;
      bones.ComputePose(RandomPose(random, *skeleton), {}, pose);
      const std::vector<Eigen::Vector3d> points = pose.points;
      Eigen::VectorXd positions = RandomPose(random, *skeleton);
      ClampToLimits(*skeleton, positions);
      bones.ComputePose(positions, {}, pose);
      pose.points = points;
      bones.Follow(pose, {}, positions);
      EXPECT_LE(LimitExcess(*skeleton, positions, nullptr), kRounding);
      bones.ComputePose(positions, {}, pose);
      EXPECT_LE((pose.points.back() - points.back()).norm(), kRounding);
    }
  }
}

TEST(BoneChainReachTest, SaysWhatTheBonesReach) {
  const auto far = EqualBones(5, BoneJoints::kSpherical);
  const BoneChain bones = TipTree(far).Bones().value();
  EXPECT_NEAR(bones.total_length(), 1, kRounding);
  EXPECT_TRUE(bones.Reaches({}, {0.999, 0, 0}));
  EXPECT_FALSE(bones.Reaches({}, {1.001, 0, 0}));
  EXPECT_TRUE(bones.Reaches({}, {0.001, 0, 0}));
}

std::string WhyNot(const std::shared_ptr<const Skeleton>& skeleton) {
  return std::string(TipTree(skeleton).Bones().status().message());
}

TEST(BoneChainRefusalTest, NamesTheJoint) {
  Random random(5);
  JointLimits limits;
  limits.lower = {-3};
  limits.upper = {3};
  EXPECT_THAT(WhyNot(RandomBones(random, BoneJoints::kHinges, 3, limits)),
              HasSubstr("joint \"j0\": has limits"));

  // Two axes that meet are no gimbal.
  SkeletonBuilder builder;
  for (int i = 0; i < 2; ++i) {
    Joint joint;
    joint.id = i == 0 ? "yaw" : "pitch";
    if (i > 0) joint.parent_id = "yaw";
    joint.type = JointType::kRevolute;
    joint.axis = Eigen::Vector3d::Unit(i);
    builder.AddJoint(joint);
  }
  RigidTransform tip;
  tip.translation = {0, 0, 1};
  builder.AddEndEffector({"tip", "pitch", tip});
  EXPECT_THAT(WhyNot(builder.Build().value()),
              HasSubstr("joint \"yaw\": want"));

  JointLimits cone;
  cone.swing_cone_rad = 1;
  Joint ball;
  ball.id = "ball";
  ball.type = JointType::kSpherical;
  ball.limits = cone;
  EXPECT_THAT(WhyNot(SkeletonBuilder()
                         .AddJoint(ball)
                         .AddEndEffector({"tip", "ball", tip})
                         .Build()
                         .value()),
              HasSubstr("joint \"ball\": has limits"));
  Joint slide = ball;
  slide.limits = {};
  slide.type = JointType::kPrismatic;
  EXPECT_THAT(WhyNot(SkeletonBuilder()
                         .AddJoint(slide)
                         .AddEndEffector({"tip", "ball", tip})
                         .Build()
                         .value()),
              HasSubstr("revolute or spherical"));
  Joint still = slide;
  still.type = JointType::kFixed;
  EXPECT_THAT(WhyNot(SkeletonBuilder()
                         .AddJoint(still)
                         .AddEndEffector({"tip", "ball", tip})
                         .Build()
                         .value()),
              HasSubstr("nothing moves"));
}

}  // namespace
}  // namespace gelenk
