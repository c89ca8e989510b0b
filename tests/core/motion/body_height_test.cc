#include "gelenk/motion/body_height.h"

#include <gtest/gtest.h>

#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {
namespace {

Joint MakeJoint(const std::string& id, const std::string& parent,
                const Eigen::Vector3d& offset) {
  Joint joint;
  joint.id = id;
  joint.parent_id = parent;
  joint.type = JointType::kSpherical;
  joint.parent_from_joint.translation = offset;
  return joint;
}

// Lies on its back, feet towards +X: its height is along its bones.
SkeletonBuilder LyingBody(double above_head_m) {
  SkeletonBuilder builder;
  builder.AddJoint(MakeJoint("Hips", "", {0, 0.2, 0}))
      .AddJoint(MakeJoint("LeftFoot", "Hips", {0.9, 0, 0}))
      .AddJoint(MakeJoint("RightFoot", "Hips", {0.9, 0, 0}))
      .AddJoint(MakeJoint("Chest", "Hips", {-0.4, 0, 0}))
      .AddJoint(MakeJoint("LeftHand", "Chest", {0, 0, 0.5}))
      .AddJoint(MakeJoint("RightHand", "Chest", {0, 0, -0.5}))
      .AddJoint(MakeJoint("Head", "Chest", {-0.2, 0, 0}));
  EndEffector top;
  top.id = "Head.end";
  top.joint_id = "Head";
  top.joint_from_end_effector.translation = {-above_head_m, 0, 0};
  builder.AddEndEffector(top);
  return builder;
}

double HeightOf(const SkeletonBuilder& builder) {
  const auto skeleton = *builder.Build();
  return BodyHeight(*skeleton, FindBodyParts(*skeleton)).value_or(0);
}

TEST(BodyHeightTest, IsTheWayFromFootToTheTopOfTheHead) {
  EXPECT_DOUBLE_EQ(HeightOf(LyingBody(0.15)), 0.9 + 0.4 + 0.2 + 0.15);
}

TEST(BodyHeightTest, HatsAddAQuarterAtMost) {
  EXPECT_DOUBLE_EQ(HeightOf(LyingBody(3)), 1.25 * (0.9 + 0.4 + 0.2));
}

TEST(BodyHeightTest, WhatIsNoBodyHasNone) {
  const auto skeleton =
      *SkeletonBuilder().AddJoint(MakeJoint("Hips", "", {0, 0, 0})).Build();
  EXPECT_FALSE(BodyHeight(*skeleton, FindBodyParts(*skeleton)).has_value());
}

}  // namespace
}  // namespace gelenk
