// What one joint may be is in joint_check_test.cc, what makes a tree in
// joint_order_test.cc.
#include "gelenk/skeleton/skeleton_builder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/testing/random_skeleton.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

Joint JointOf(const std::string& id, const std::string& parent_id,
              JointType type = JointType::kRevolute) {
  Joint joint;
  joint.id = id;
  joint.parent_id = parent_id;
  joint.type = type;
  joint.axis = Eigen::Vector3d::UnitZ();
  return joint;
}

std::vector<std::string> Lines(const SkeletonBuilder& builder) {
  const auto built = builder.Build();
  if (!built.ok()) {
    EXPECT_EQ(built.status().code(), absl::StatusCode::kInvalidArgument);
  }
  return ViolationLines(built.status());
}

SkeletonBuilder Arm() {
  SkeletonBuilder builder;
  builder.AddJoint(JointOf("shoulder", ""))
      .AddJoint(JointOf("elbow", "shoulder"))
      .AddJoint(JointOf("wrist", "elbow"));
  return builder;
}

TEST(SkeletonBuilderTest, BuildsWhatItWasGiven) {
  const auto arm = Arm().AddEndEffector({"palm", "wrist", {}}).Build();
  ASSERT_TRUE(arm.ok()) << arm.status();
  EXPECT_EQ((*arm)->joint_count(), 3);
  EXPECT_EQ((*arm)->joint(2).id, "wrist");
  EXPECT_EQ((*arm)->end_effectors()[0].id, "palm");
}

TEST(SkeletonBuilderTest, BuildsAgain) {
  SkeletonBuilder builder = Arm();
  EXPECT_EQ(builder.Build().value()->joint_count(), 3);
  builder.AddJoint(JointOf("finger", "wrist"));
  EXPECT_EQ(builder.Build().value()->joint_count(), 4);
}

TEST(SkeletonBuilderTest, ListsEverythingAtOnce) {
  SkeletonBuilder builder = Arm();
  Joint bad = JointOf("bad", "nobody");
  bad.axis.setZero();
  bad.mimic = Mimic{"nothing", 1, 0};
  builder.AddJoint(bad)
      .AddJoint(JointOf("elbow", "wrist"))
      .AddEndEffector({"palm", "nowhere", {}})
      .SetUp(Eigen::Vector3d::Zero())
      .SetRestPositions(Eigen::VectorXd::Zero(1));
  EXPECT_THAT(Lines(builder),
              ElementsAre("joints[3].axis: want a unit vector, got (0, 0, 0)",
                          "joints[3].mimic.joint_id: no joint \"nothing\"",
                          "joints[4].joint_id: duplicate \"elbow\"",
                          "joints[3].parent_joint_id: no joint \"nobody\"",
                          "end_effectors[0].joint_id: no joint \"nowhere\"",
                          "up: want a direction, got (0, 0, 0)",
                          "rest_pose.positions: want 4 numbers, got 1"));
}

TEST(SkeletonBuilderTest, EmptyHasNoRoot) {
  EXPECT_THAT(Lines(SkeletonBuilder()),
              ElementsAre("joints: want one root, got 0"));
}

TEST(SkeletonBuilderTest, CycleIsRefused) {
  SkeletonBuilder builder;
  builder.AddJoint(JointOf("root", ""))
      .AddJoint(JointOf("a", "b"))
      .AddJoint(JointOf("b", "a"));
  EXPECT_THAT(
      Lines(builder),
      ElementsAre(
          "joints[1].parent_joint_id: joint \"a\" is its own ancestor"));
}

TEST(SkeletonBuilderTest, MimicFollowsAJointOfItsOwnNumber) {
  SkeletonBuilder builder = Arm();
  Joint first = JointOf("first", "wrist");
  first.mimic = Mimic{"elbow", 2, 0};
  Joint second = JointOf("second", "wrist");
  second.mimic = Mimic{"first", 1, 0};
  Joint third = JointOf("third", "wrist");
  third.mimic = Mimic{"ball", 1, 0};
  Joint narcissus = JointOf("narcissus", "wrist");
  narcissus.mimic = Mimic{"narcissus", 1, 0};
  builder.AddJoint(first)
      .AddJoint(second)
      .AddJoint(JointOf("ball", "wrist", JointType::kSpherical))
      .AddJoint(third)
      .AddJoint(narcissus);
  EXPECT_THAT(
      Lines(builder),
      ElementsAre("joints[4].mimic.joint_id: joint \"first\" is no revolute or "
                  "prismatic joint of its own",
                  "joints[6].mimic.joint_id: joint \"ball\" is no revolute or "
                  "prismatic joint of its own",
                  "joints[7].mimic.joint_id: joint \"narcissus\" is no "
                  "revolute or prismatic joint of its own"));
}

TEST(SkeletonBuilderTest, MimicMayFollowAJointAddedLater) {
  Joint first = JointOf("first", "");
  first.mimic = Mimic{"second", 2, 0.5};
  const auto skeleton = SkeletonBuilder()
                            .AddJoint(first)
                            .AddJoint(JointOf("second", "first"))
                            .Build();
  ASSERT_TRUE(skeleton.ok()) << skeleton.status();
  EXPECT_EQ((*skeleton)->span(0).mimicked, 1);
  EXPECT_EQ((*skeleton)->position_count(), 1);
}

TEST(SkeletonBuilderTest, EndEffectorsAreChecked) {
  SkeletonBuilder builder = Arm();
  RigidTransform crooked;
  crooked.translation.x() = INFINITY;
  crooked.rotation.w() = 1.1;
  builder.AddEndEffector({"palm", "wrist", {}})
      .AddEndEffector({"palm", "elbow", {}})
      .AddEndEffector({"", "Wrist", {}})
      .AddEndEffector({"tip", "wrist", crooked});
  EXPECT_THAT(
      Lines(builder),
      ElementsAre("end_effectors[1].end_effector_id: duplicate \"palm\"",
                  "end_effectors[2].end_effector_id: want 1 to 63 bytes, got 0",
                  "end_effectors[2].joint_id: no joint \"Wrist\"",
                  "end_effectors[3].joint_from_end_effector.translation: want "
                  "finite numbers, got (inf, 0, 0)",
                  "end_effectors[3].joint_from_end_effector.rotation: want a "
                  "unit quaternion, got (0, 0, 0, 1.1)"));
}

TEST(SkeletonBuilderTest, UpIsADirectionOfAnyLength) {
  EXPECT_EQ(Arm().SetUp({0, 0, 9.81}).Build().value()->up(),
            Eigen::Vector3d::UnitZ());
  EXPECT_THAT(Lines(Arm().SetUp({0, NAN, 0})),
              ElementsAre("up: want a direction, got (0, nan, 0)"));
}

TEST(SkeletonBuilderTest, BoundsFromBothSides) {
  SkeletonBounds bounds;
  bounds.max_joints = 3;
  bounds.max_depth = 3;
  bounds.max_end_effectors = 1;
  SkeletonBuilder builder = Arm();
  builder.SetBounds(bounds).AddEndEffector({"palm", "wrist", {}});
  EXPECT_THAT(Lines(builder), IsEmpty());
  SkeletonBuilder larger = builder;
  larger.AddJoint(JointOf("finger", "wrist"))
      .AddEndEffector({"tip", "finger", {}});
  EXPECT_THAT(Lines(larger),
              ElementsAre("joints: want at most 3, got 4",
                          "end_effectors: want at most 1, got 2"));
  bounds.max_joints = 4;
  SkeletonBuilder deeper = builder;
  deeper.SetBounds(bounds).AddJoint(JointOf("finger", "wrist"));
  EXPECT_THAT(Lines(deeper),
              ElementsAre("joints[3].parent_joint_id: deeper than 3 joints"));
}

TEST(SkeletonBuilderTest, PlanarSkeletonStaysInThePlane) {
  SkeletonBuilder builder = Arm();
  Joint slider = JointOf("slider", "wrist", JointType::kPrismatic);
  slider.axis = Eigen::Vector3d(0.6, 0.8, 0);
  slider.parent_from_joint.translation = {1, 2, 0};
  slider.parent_from_joint.rotation = Eigen::Quaterniond(0.6, 0, 0, -0.8);
  Joint reversed = JointOf("reversed", "slider");
  reversed.axis = -Eigen::Vector3d::UnitZ();
  builder.SetPlanar(true)
      .AddJoint(slider)
      .AddJoint(reversed)
      .AddJoint(JointOf("plane", "slider", JointType::kPlanar))
      .AddJoint(JointOf("sensor", "slider", JointType::kFixed));
  EXPECT_THAT(Lines(builder), IsEmpty());
}

TEST(SkeletonBuilderTest, PlanarSkeletonRefusesWhatLeavesThePlane) {
  SkeletonBuilder builder = Arm();
  Joint tilted = JointOf("tilted", "wrist");
  tilted.axis = Eigen::Vector3d(0, 0.6, 0.8);
  Joint lift = JointOf("lift", "wrist", JointType::kPrismatic);
  Joint above = JointOf("above", "wrist", JointType::kFixed);
  above.parent_from_joint.translation.z() = 1e-6;
  Joint rolled = JointOf("rolled", "wrist", JointType::kFixed);
  rolled.parent_from_joint.rotation = Eigen::Quaterniond(0.8, 0.6, 0, 0);
  builder.SetPlanar(true)
      .AddJoint(tilted)
      .AddJoint(lift)
      .AddJoint(JointOf("ball", "wrist", JointType::kSpherical))
      .AddJoint(JointOf("free", "wrist", JointType::kFree))
      .AddJoint(above)
      .AddJoint(rolled);
  EXPECT_THAT(Lines(builder),
              ElementsAre("joints[3].axis: leaves the XY plane",
                          "joints[4].axis: leaves the XY plane",
                          "joints[5].type: a spherical joint leaves the plane",
                          "joints[6].type: a free joint leaves the plane",
                          "joints[7].parent_from_joint: leaves the XY plane",
                          "joints[8].parent_from_joint: leaves the XY plane"));
}

// A root of two numbers added last: its numbers come first in the skeleton.
SkeletonBuilder BackToFront() {
  SkeletonBuilder builder;
  Joint follower = JointOf("follower", "hip");
  follower.mimic = Mimic{"knee", 1, 0};
  builder.AddJoint(JointOf("knee", "hip"))
      .AddJoint(follower)
      .AddJoint(JointOf("foot", "knee", JointType::kSpherical))
      .AddJoint(JointOf("hip", "", JointType::kPlanar));
  return builder;
}

TEST(SkeletonBuilderTest, JointsAreMovedBehindTheirParents) {
  const auto leg = BackToFront().Build().value();
  EXPECT_EQ(leg->joint(0).id, "hip");
  EXPECT_EQ(leg->joint(1).id, "knee");
  EXPECT_EQ(leg->joint(2).id, "follower");
  EXPECT_EQ(leg->joint(3).id, "foot");
  EXPECT_EQ(leg->span(2).mimicked, 1);
  EXPECT_EQ(leg->span(3).parent, 1);
}

TEST(SkeletonBuilderTest, RestPositionsMoveWithTheirJoints) {
  Eigen::VectorXd given(8);
  given << 0.1, 0.6, 0, 0, 0.8, 1, 2, 3;
  Eigen::VectorXd stored(8);
  stored << 1, 2, 3, 0.1, 0.6, 0, 0, 0.8;
  const auto leg = BackToFront().SetRestPositions(given).Build();
  ASSERT_TRUE(leg.ok()) << leg.status();
  EXPECT_EQ((*leg)->rest_positions(), stored);
}

TEST(SkeletonBuilderTest, RestPositionsAreNamedAsGiven) {
  Eigen::VectorXd given(8);
  given << NAN, 0.6, 0, 0, 0.7, 1, 2, INFINITY;
  EXPECT_THAT(
      Lines(BackToFront().SetRestPositions(given)),
      ElementsAre("rest_pose.positions[0]: want a finite number, got nan",
                  "rest_pose.positions[1]: want a unit quaternion, got "
                  "(0.6, 0, 0, 0.7)",
                  "rest_pose.positions[7]: want a finite number, got inf"));
  EXPECT_THAT(Lines(BackToFront().SetRestPositions(Eigen::VectorXd::Zero(9))),
              ElementsAre("rest_pose.positions: want 8 numbers, got 9"));
}

TEST(SkeletonBuilderTest, NearUnitInputIsNormalised) {
  Joint root = JointOf("root", "", JointType::kSpherical);
  root.parent_from_joint.rotation.w() = 1 + 5e-4;
  Eigen::VectorXd rest(4);
  rest << 0, 0, 0, 1 - 5e-4;
  RigidTransform tip;
  tip.rotation.w() = 1 - 5e-4;
  const auto skeleton = SkeletonBuilder()
                            .AddJoint(root)
                            .AddEndEffector({"tip", "root", tip})
                            .SetRestPositions(rest)
                            .Build()
                            .value();
  EXPECT_EQ(skeleton->joint(0).parent_from_joint.rotation.w(), 1);
  EXPECT_EQ(skeleton->rest_positions()[3], 1);
  EXPECT_EQ(skeleton->end_effectors()[0].joint_from_end_effector.rotation.w(),
            1);
}

TEST(SkeletonBuilderTest, ManyErrorsMakeAShortMessage) {
  SkeletonBuilder builder;
  for (int i = 0; i < 1000; ++i) {
    builder.AddJoint(JointOf(std::string(1000, 'x'), std::string(1000, 'y')));
  }
  EXPECT_LT(builder.Build().status().message().size(), 4000u);
}

TEST(SkeletonBuilderTest, RandomTreesBuild) {
  Random random(1);
  for (int tree = 0; tree < 50; ++tree) {
    const auto skeleton = RandomSkeleton(random);
    for (int i = 0; i < skeleton->joint_count(); ++i) {
      EXPECT_LT(skeleton->span(i).parent, i);
    }
  }
}

}  // namespace
}  // namespace gelenk
