#include "gelenk/retarget/body_model.h"

#include <gtest/gtest.h>

#include "gelenk/math/rotation.h"
#include "gelenk/retarget/body_pose.h"
#include "gelenk/retarget/humanoid.h"
#include "tests/testing/rig_family.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

std::shared_ptr<const BodyModel> ModelOf(
    std::shared_ptr<const Skeleton> skeleton) {
  const auto map = ProposeJointMap(*skeleton);
  return *MakeBodyModel(skeleton, *map);
}

BodyPose RestOf(const BodyModel& model) {
  WorldTransforms world_from_joints;
  ForwardKinematics(*model.skeleton, model.skeleton->rest_positions(),
                    world_from_joints);
  BodyPose pose;
  ReadBodyPose(model, world_from_joints, pose);
  return pose;
}

TEST(BodyModelTest, ATPoseIsTheIdentity) {
  const auto model = ModelOf(MakeHumanoid());
  EXPECT_TRUE(model->reference.IsRestPose());
  EXPECT_NEAR(model->reference.score, 1, 0.05);
  const BodyPose pose = RestOf(*model);
  for (int i = 0; i < kBodyRoleCount; ++i) {
    EXPECT_LT(AngleBetween(pose.rotations[i], Eigen::Quaterniond::Identity()),
              1e-9)
        << BodyRoleName(static_cast<BodyRole>(i));
  }
  // The soles that the end effectors tell.
  for (int side : kSides) {
    EXPECT_NEAR(pose.foot_points[side][kHeel].y(), 0, 1e-9);
    EXPECT_NEAR(pose.foot_points[side][kTip].y(), 0, 1e-9);
    EXPECT_NEAR(pose.foot_points[side][kBall].y(),
                model->planted_heights[side][kBall], 1e-9);
  }
  EXPECT_NEAR(model->leg_length, 0.845, 1e-9);
}

TEST(BodyModelTest, ABodyThatLooksElsewhereAndIsSmallerIsTheSameBody) {
  const auto& family = testing::RigFamilies()[0];
  const BodyPose pose = RestOf(*ModelOf(testing::BodyOf(family)));
  EXPECT_LT(AngleBetween(pose.rotation(BodyRole::kLeftThigh),
                         Eigen::Quaterniond::Identity()),
            1e-9);
  EXPECT_GT(pose.position(BodyRole::kLeftHand).x(), 0.5);
}

TEST(BodyModelTest, ALyingRestPoseNeedsAReference) {
  // All bones along X, as some recorders have them.
  const auto& family = testing::RigFamilies()[0];
  const auto standing = testing::BodyOf(family);
  const auto map = ProposeJointMap(*standing);
  Eigen::VectorXd folded = standing->rest_positions();
  const int thigh = map->joint(BodyRole::kLeftThigh);
  const Eigen::Quaterniond up(
      Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  StoreXyzw(up, folded.data() + standing->span(thigh).quaternion_offset);
  const ReferencePose bad =
      ScorePose(*standing, *map, folded, Eigen::Vector3d::UnitY());
  EXPECT_LT(bad.score, -1);
  BodyModelOptions options;
  options.reference_positions = standing->rest_positions();
  EXPECT_TRUE(MakeBodyModel(standing, *map, nullptr, options).ok());
  options.reference_positions = Eigen::VectorXd::Zero(3);
  EXPECT_THAT(MakeBodyModel(standing, *map, nullptr, options).status(),
              testing::Fails(absl::StatusCode::kInvalidArgument, "positions"));
}

TEST(BodyModelTest, NoBodyIsRefused) {
  EXPECT_THAT(MakeBodyModel(MakeHumanoid(), JointMap()).status(),
              testing::Fails(absl::StatusCode::kInvalidArgument, "joint_map"));
}

}  // namespace
}  // namespace gelenk
