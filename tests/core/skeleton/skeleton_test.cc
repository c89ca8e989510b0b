#include "gelenk/skeleton/skeleton.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::SkeletonRecipe;

Joint JointOf(const std::string& id, const std::string& parent_id,
              JointType type) {
  Joint joint;
  joint.id = id;
  joint.parent_id = parent_id;
  joint.type = type;
  return joint;
}

std::shared_ptr<const Skeleton> Body() {
  Joint thumb = JointOf("thumb", "hand", JointType::kRevolute);
  thumb.mimic = Mimic{"elbow", 1, 0};
  RigidTransform palm;
  palm.translation = {0.1, 0, 0};
  return SkeletonBuilder()
      .AddJoint(JointOf("pelvis", "", JointType::kFree))
      .AddJoint(JointOf("shoulder", "pelvis", JointType::kSpherical))
      .AddJoint(JointOf("elbow", "shoulder", JointType::kRevolute))
      .AddJoint(JointOf("hand", "elbow", JointType::kFixed))
      .AddJoint(thumb)
      .AddJoint(JointOf("skid", "pelvis", JointType::kPlanar))
      .AddEndEffector({"palm", "hand", palm})
      .AddEndEffector({"elbow", "shoulder", palm})
      .Build()
      .value();
}

TEST(SkeletonTest, NumbersArePackedInOrder) {
  const auto body = Body();
  EXPECT_EQ(body->position_count(), 7 + 4 + 1 + 3);
  EXPECT_EQ(body->velocity_count(), 6 + 3 + 1 + 3);
  const int positions[] = {0, 7, 11, -1, -1, 12};
  const int velocities[] = {0, 6, 9, -1, -1, 10};
  const int parents[] = {-1, 0, 1, 2, 3, 0};
  const int mimicked[] = {-1, -1, -1, -1, 2, -1};
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(body->span(i).position_offset, positions[i]) << i;
    EXPECT_EQ(body->span(i).velocity_offset, velocities[i]) << i;
    EXPECT_EQ(body->span(i).parent, parents[i]) << i;
    EXPECT_EQ(body->span(i).mimicked, mimicked[i]) << i;
  }
}

TEST(SkeletonTest, FindsJointsById) {
  const auto body = Body();
  EXPECT_EQ(body->FindJoint("pelvis"), 0);
  EXPECT_EQ(body->FindJoint("skid"), 5);
  EXPECT_EQ(body->FindJoint("Pelvis"), -1);
  EXPECT_EQ(body->FindJoint(""), -1);
}

TEST(SkeletonTest, FindsEffectorsAndJointOrigins) {
  const auto body = Body();
  const auto palm = body->FindEffector("palm");
  ASSERT_TRUE(palm.has_value());
  EXPECT_EQ(palm->joint, 3);
  EXPECT_EQ(palm->joint_from_effector.translation.x(), 0.1);
  const auto hand = body->FindEffector("hand");
  ASSERT_TRUE(hand.has_value());
  EXPECT_EQ(hand->joint, 3);
  EXPECT_TRUE(hand->joint_from_effector.translation.isZero(0));
  EXPECT_FALSE(body->FindEffector("tail").has_value());
}

TEST(SkeletonTest, EndEffectorGoesBeforeAJointOfTheSameId) {
  EXPECT_EQ(Body()->FindEffector("elbow")->joint, 1);
}

TEST(SkeletonTest, RestIsNeutralAndUpIsYUnlessGiven) {
  const auto body = Body();
  Eigen::VectorXd neutral = Eigen::VectorXd::Zero(15);
  neutral[6] = neutral[10] = 1;
  EXPECT_EQ(body->rest_positions(), neutral);
  EXPECT_EQ(body->up(), Eigen::Vector3d::UnitY());
}

TEST(SkeletonTest, ByteSizeGrowsWithTheJoints) {
  Random random(1);
  SkeletonRecipe recipe;
  recipe.joint_count = 10;
  const size_t ten = RandomSkeleton(random, recipe)->ByteSize();
  recipe.joint_count = 100;
  const size_t hundred = RandomSkeleton(random, recipe)->ByteSize();
  EXPECT_GT(ten, 10 * sizeof(Joint));
  EXPECT_GT(hundred, 5 * ten);
}

}  // namespace
}  // namespace gelenk
