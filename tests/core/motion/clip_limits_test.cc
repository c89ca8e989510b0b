#include "gelenk/motion/clip_limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "gelenk/math/rotation.h"
#include "gelenk/motion/bone_axes.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kDegree = std::numbers::pi / 180;
// Limits are compared with the very numbers they were made of; decomposing a
// rotation costs a few roundings.
constexpr double kRounding = 1e-12;

Joint MakeJoint(const std::string& id, const std::string& parent,
                JointType type, const Eigen::Vector3d& offset) {
  Joint joint;
  joint.id = id;
  joint.parent_id = parent;
  joint.type = type;
  joint.parent_from_joint.translation = offset;
  return joint;
}

// A free root, a ball joint whose bone points along +X, and a hinge about +X at
// its end.
std::shared_ptr<const Skeleton> Arm() {
  return *SkeletonBuilder()
              .AddJoint(MakeJoint("hips", "", JointType::kFree, {0, 0, 0}))
              .AddJoint(MakeJoint("shoulder", "hips", JointType::kSpherical,
                                  {0, 0.5, 0}))
              .AddJoint(MakeJoint("elbow", "shoulder", JointType::kRevolute,
                                  {0.3, 0, 0}))
              .Build();
}
constexpr int kShoulder = 1;
constexpr int kElbow = 2;

// Rows of q in Arm().
constexpr int kHipsRow = 0;
constexpr int kShoulderRow = 7;
constexpr int kElbowRow = 11;

Eigen::MatrixXd RestClip(const Skeleton& skeleton, int frame_count) {
  return NeutralPositions(skeleton).replicate(1, frame_count);
}

void SetShoulder(const Eigen::Quaterniond& rotation, Eigen::MatrixXd& clip,
                 int frame) {
  StoreXyzw(rotation, clip.col(frame).data() + kShoulderRow);
}

Eigen::Quaterniond Turn(double angle_rad, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
}

const Eigen::Vector3d kBone = Eigen::Vector3d::UnitX();
const Eigen::Vector3d kAcross = Eigen::Vector3d::UnitZ();

void ExpectEveryFrameInside(const Skeleton& limited,
                            const Eigen::MatrixXd& clip) {
  for (int frame = 0; frame < clip.cols(); ++frame) {
    int joint = -1;
    EXPECT_LE(LimitExcess(limited, clip.col(frame), &joint), kRounding)
        << "frame " << frame << ", joint " << joint;
  }
}

TEST(BoneAxesTest, PointToTheFirstChildElsewhere) {
  EXPECT_THAT(BoneAxes(*Arm()),
              ElementsAre(Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 0, 0),
                          Eigen::Vector3d(0, 1, 0)));
}

TEST(BoneAxesTest, SkipJointsInOnePlaceAndTakeEndEffectors) {
  EndEffector tip;
  tip.id = "tip";
  tip.joint_id = "b";
  tip.joint_from_end_effector.translation = {0, 0, -0.2};
  const auto skeleton =
      *SkeletonBuilder()
           .AddJoint(MakeJoint("a", "", JointType::kFree, {0, 0, 0}))
           .AddJoint(MakeJoint("b", "a", JointType::kSpherical, {0, 0, 0}))
           .AddJoint(MakeJoint("c", "a", JointType::kSpherical, {-2, 0, 0}))
           .AddEndEffector(tip)
           .Build();
  EXPECT_THAT(BoneAxes(*skeleton),
              ElementsAre(Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 0, -1),
                          Eigen::Vector3d(0, 1, 0)));
}

TEST(ClipLimitsTest, EveryFrameOfARandomWalkIsInside) {
  const auto skeleton = Arm();
  Eigen::MatrixXd clip = RestClip(*skeleton, 400);
  std::mt19937 random(7);
  std::normal_distribution<double> step(0, 0.1);
  Eigen::VectorXd velocity(skeleton->velocity_count());
  for (int frame = 1; frame < clip.cols(); ++frame) {
    for (double& v : velocity) v = step(random);
    Eigen::VectorXd next(skeleton->position_count());
    Integrate(*skeleton, clip.col(frame - 1), velocity, next);
    clip.col(frame) = next;
  }
  const auto limited = LimitToClip(*skeleton, clip);
  ASSERT_TRUE(limited.ok()) << limited.status();
  ExpectEveryFrameInside(*limited->skeleton, clip);
}

TEST(ClipLimitsTest, SwingEndsFiveDegreesBeyondTheClip) {
  const auto skeleton = Arm();
  Eigen::MatrixXd clip = RestClip(*skeleton, 3);
  SetShoulder(Turn(40 * kDegree, kAcross), clip, 1);
  const auto limited = LimitToClip(*skeleton, clip);
  ASSERT_TRUE(limited.ok()) << limited.status();
  const Joint& shoulder = limited->skeleton->joint(kShoulder);
  EXPECT_EQ(shoulder.axis, kBone);
  EXPECT_NEAR(*shoulder.limits.swing_cone_rad, 45 * kDegree, kRounding);

  SetShoulder(Turn(44 * kDegree, kAcross), clip, 1);
  EXPECT_EQ(LimitExcess(*limited->skeleton, clip.col(1), nullptr), 0);
  SetShoulder(Turn(46 * kDegree, -kAcross), clip, 1);
  EXPECT_NEAR(LimitExcess(*limited->skeleton, clip.col(1), nullptr), kDegree,
              kRounding);
}

TEST(ClipLimitsTest, TwistEndsFiveDegreesBeyondTheClipOnBothSides) {
  const auto skeleton = Arm();
  Eigen::MatrixXd clip = RestClip(*skeleton, 3);
  SetShoulder(Turn(-20 * kDegree, kBone), clip, 1);
  SetShoulder(Turn(30 * kDegree, kBone), clip, 2);
  const auto limited = LimitToClip(*skeleton, clip);
  ASSERT_TRUE(limited.ok()) << limited.status();
  ExpectEveryFrameInside(*limited->skeleton, clip);

  SetShoulder(Turn(-26 * kDegree, kBone), clip, 1);
  SetShoulder(Turn(36 * kDegree, kBone), clip, 2);
  for (int frame : {1, 2}) {
    int joint = -1;
    EXPECT_NEAR(LimitExcess(*limited->skeleton, clip.col(frame), &joint),
                kDegree, kRounding);
    EXPECT_EQ(joint, kShoulder);
  }
}

TEST(ClipLimitsTest, TwistIsFollowedBeyondHalfATurn) {
  const auto skeleton = Arm();
  Eigen::MatrixXd clip = RestClip(*skeleton, 41);
  // From 100 to 300 degrees, which DecomposeSwingTwist reports as 100 to 180
  // and -180 to -60.
  for (int frame = 0; frame < clip.cols(); ++frame) {
    SetShoulder(Turn((100 + 5 * frame) * kDegree, kBone), clip, frame);
  }
  const auto limited = LimitToClip(*skeleton, clip);
  ASSERT_TRUE(limited.ok()) << limited.status();
  ExpectEveryFrameInside(*limited->skeleton, clip);
  const JointLimits& limits = limited->skeleton->joint(kShoulder).limits;
  EXPECT_NEAR(*limits.twist_upper_rad - *limits.twist_lower_rad, 210 * kDegree,
              kRounding);
  SetShoulder(Turn(94 * kDegree, kBone), clip, 0);
  EXPECT_NEAR(LimitExcess(*limited->skeleton, clip.col(0), nullptr), kDegree,
              kRounding);
  SetShoulder(Turn(306 * kDegree, kBone), clip, 0);
  EXPECT_NEAR(LimitExcess(*limited->skeleton, clip.col(0), nullptr), kDegree,
              kRounding);
}

TEST(ClipLimitsTest, AWholeTurnOfTwistIsNoLimit) {
  const auto skeleton = Arm();
  Eigen::MatrixXd clip = RestClip(*skeleton, 38);
  for (int frame = 0; frame < clip.cols(); ++frame) {
    SetShoulder(Turn(10 * frame * kDegree, kBone), clip, frame);
  }
  const auto limited = LimitToClip(*skeleton, clip);
  ASSERT_TRUE(limited.ok()) << limited.status();
  const JointLimits& limits = limited->skeleton->joint(kShoulder).limits;
  EXPECT_FALSE(limits.twist_lower_rad.has_value());
  EXPECT_FALSE(limits.twist_upper_rad.has_value());
  EXPECT_NEAR(*limits.swing_cone_rad, 5 * kDegree, kRounding);
  EXPECT_THAT(limited->twisting_whole_turn, ElementsAre(kShoulder));
  EXPECT_THAT(limited->swinging_half_turn, IsEmpty());
}

TEST(ClipLimitsTest, TwistIsFreeWhereTheSwingComesNearHalfATurn) {
  const auto skeleton = Arm();
  Eigen::MatrixXd clip = RestClip(*skeleton, 2);
  SetShoulder(Turn(172 * kDegree, kAcross), clip, 1);
  const auto limited = LimitToClip(*skeleton, clip);
  ASSERT_TRUE(limited.ok()) << limited.status();
  const JointLimits& limits = limited->skeleton->joint(kShoulder).limits;
  EXPECT_FALSE(limits.twist_lower_rad.has_value());
  EXPECT_NEAR(*limits.swing_cone_rad, 177 * kDegree, kRounding);
  EXPECT_THAT(limited->swinging_half_turn, ElementsAre(kShoulder));

  SetShoulder(Turn(176 * kDegree, kAcross), clip, 1);
  EXPECT_FALSE(LimitToClip(*skeleton, clip)
                   ->skeleton->joint(kShoulder)
                   .limits.HasRotationLimits());
}

TEST(ClipLimitsTest, HingesGetTheirRange) {
  const auto skeleton = Arm();
  Eigen::MatrixXd clip = RestClip(*skeleton, 2);
  clip(kElbowRow, 0) = -0.2;
  clip(kElbowRow, 1) = 1.5;
  const auto limited = LimitToClip(*skeleton, clip);
  ASSERT_TRUE(limited.ok()) << limited.status();
  const JointLimits& limits = limited->skeleton->joint(kElbow).limits;
  EXPECT_THAT(limits.lower, ElementsAre(-0.2 - 5 * kDegree));
  EXPECT_THAT(limits.upper, ElementsAre(1.5 + 5 * kDegree));
}

TEST(ClipLimitsTest, SlidersGetTheirRangeAndTheMarginOfLength) {
  Joint slider = MakeJoint("slider", "", JointType::kPrismatic, {0, 0, 0});
  slider.limits.max_velocity = {3};
  const auto skeleton = *SkeletonBuilder().AddJoint(slider).Build();
  const Eigen::MatrixXd clip = Eigen::RowVector3d(0.5, -1, 2);
  const auto limited = LimitToClip(*skeleton, clip, {.length_m = 0.25});
  ASSERT_TRUE(limited.ok()) << limited.status();
  const JointLimits& limits = limited->skeleton->joint(0).limits;
  EXPECT_THAT(limits.lower, ElementsAre(-1.25));
  EXPECT_THAT(limits.upper, ElementsAre(2.25));
  EXPECT_THAT(limits.max_velocity, ElementsAre(3));
}

TEST(ClipLimitsTest, TheRootGoesAnywhereAndLeansAboutUp) {
  const auto skeleton = Arm();
  Eigen::MatrixXd clip = RestClip(*skeleton, 3);
  clip(kHipsRow, 1) = 100;
  StoreXyzw(Turn(20 * kDegree, Eigen::Vector3d::UnitX()),
            clip.col(2).data() + kHipsRow + 3);
  const auto limited = LimitToClip(*skeleton, clip);
  ASSERT_TRUE(limited.ok()) << limited.status();
  const Joint& hips = limited->skeleton->joint(0);
  EXPECT_THAT(hips.limits.lower, IsEmpty());
  EXPECT_EQ(hips.axis, skeleton->up());
  EXPECT_NEAR(*hips.limits.swing_cone_rad, 25 * kDegree, kRounding);
}

TEST(ClipLimitsTest, AFreeJointBelowTheRootIsBoxed) {
  const auto skeleton =
      *SkeletonBuilder()
           .AddJoint(MakeJoint("a", "", JointType::kFixed, {0, 0, 0}))
           .AddJoint(MakeJoint("b", "a", JointType::kFree, {0, 1, 0}))
           .Build();
  Eigen::MatrixXd clip = RestClip(*skeleton, 2);
  clip(1, 1) = 0.3;
  const auto limited = LimitToClip(*skeleton, clip, {.length_m = 0.1});
  ASSERT_TRUE(limited.ok()) << limited.status();
  EXPECT_THAT(limited->skeleton->joint(1).limits.upper,
              ElementsAre(0.1, 0.4, 0.1));
}

TEST(ClipLimitsTest, KeepsNamesRestPoseAndEndEffectors) {
  const auto skeleton = Arm();
  const auto limited = LimitToClip(*skeleton, RestClip(*skeleton, 1));
  ASSERT_TRUE(limited.ok()) << limited.status();
  ASSERT_EQ(limited->skeleton->joint_count(), skeleton->joint_count());
  for (int i = 0; i < skeleton->joint_count(); ++i) {
    EXPECT_EQ(limited->skeleton->joint(i).id, skeleton->joint(i).id);
    EXPECT_EQ(limited->skeleton->span(i).position_offset,
              skeleton->span(i).position_offset);
  }
  EXPECT_EQ(limited->skeleton->rest_positions(), skeleton->rest_positions());
}

TEST(ClipLimitsTest, RefusesClipsThatDoNotFit) {
  const auto skeleton = Arm();
  EXPECT_THAT(
      std::string(
          LimitToClip(*skeleton, Eigen::MatrixXd(12, 0)).status().message()),
      HasSubstr("want a frame or more"));
  EXPECT_THAT(std::string(LimitToClip(*skeleton, Eigen::MatrixXd::Zero(3, 1))
                              .status()
                              .message()),
              HasSubstr("want 12 rows, got 3"));
}

}  // namespace
}  // namespace gelenk
