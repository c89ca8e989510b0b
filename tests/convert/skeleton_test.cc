#include "convert/skeleton.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <string>

#include "gelenk/kinematics/forward_kinematics.h"
#include "tests/testing/example_bodies.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"
#include "tests/testing/violation_lines.h"

namespace gelenk::convert {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// Every field of a joint that can be set together.
v1::Skeleton Everything() {
  v1::Skeleton proto;
  proto.set_dimension(v1::DIMENSION_SPATIAL);
  v1::Joint* root = proto.add_joints();
  root->set_joint_id("root");
  root->set_type(v1::JOINT_TYPE_PLANAR);
  root->mutable_axis()->set_z(1);
  v1::JointLimits* limits = root->mutable_limits();
  for (double x : {-1, -2, -3}) limits->add_lower(x);
  for (double x : {1, 2, 3}) limits->add_upper(x);
  for (double x : {4, 5, 6}) limits->add_max_velocity(x);
  for (double x : {7, 8, 9}) limits->add_max_acceleration(x);
  for (double x : {0.5, 1.5, 2.5}) root->add_stiffness(x);
  root->set_link_length_m(0.25);
  root->mutable_link_direction()->set_y(1);
  root->set_link_mass_kg(12);
  root->mutable_link_center_of_mass()->set_z(0.125);

  v1::Joint* ball = proto.add_joints();
  ball->set_joint_id("ball");
  ball->set_parent_joint_id("root");
  ball->set_type(v1::JOINT_TYPE_SPHERICAL);
  ball->mutable_parent_from_joint()->mutable_translation()->set_x(0.5);
  ball->mutable_parent_from_joint()->mutable_rotation()->set_y(0.6);
  ball->mutable_parent_from_joint()->mutable_rotation()->set_w(0.8);
  ball->mutable_axis()->set_x(1);
  ball->mutable_limits()->set_swing_cone_rad(1);
  ball->mutable_limits()->set_twist_lower_rad(-0.5);
  ball->mutable_limits()->set_twist_upper_rad(0.75);

  v1::Joint* hinge = proto.add_joints();
  hinge->set_joint_id("hinge");
  hinge->set_parent_joint_id("ball");
  hinge->set_type(v1::JOINT_TYPE_REVOLUTE);
  hinge->mutable_axis()->set_y(1);

  v1::Joint* follower = proto.add_joints();
  follower->set_joint_id("follower");
  follower->set_parent_joint_id("hinge");
  follower->set_type(v1::JOINT_TYPE_REVOLUTE);
  follower->mutable_axis()->set_y(1);
  follower->mutable_mimic()->set_joint_id("hinge");
  follower->mutable_mimic()->set_multiplier(-0.5);
  follower->mutable_mimic()->set_offset(0.125);

  v1::EndEffector* tip = proto.add_end_effectors();
  tip->set_end_effector_id("tip");
  tip->set_joint_id("follower");
  tip->mutable_joint_from_end_effector()->mutable_translation()->set_y(2);
  proto.mutable_up()->set_z(1);
  // q of root, ball, hinge.
  for (double q : {0.1, 0.2, 0.3, 0.0, 0.0, 0.6, 0.8, 0.4}) {
    proto.mutable_rest_pose()->add_positions(q);
  }
  return proto;
}

v1::Skeleton ThereAndBack(const v1::Skeleton& proto) {
  const auto skeleton = FromProto(proto);
  EXPECT_TRUE(skeleton.ok()) << skeleton.status();
  v1::Skeleton again;
  if (skeleton.ok()) ToProto(**skeleton, &again);
  return again;
}

TEST(ConvertSkeletonTest, EveryFieldHasItsPlace) {
  const auto skeleton = FromProto(Everything()).value();
  const Joint& root = skeleton->joint(0);
  EXPECT_EQ(root.type, JointType::kPlanar);
  EXPECT_THAT(root.limits.lower, ElementsAre(-1, -2, -3));
  EXPECT_THAT(root.limits.upper, ElementsAre(1, 2, 3));
  EXPECT_THAT(root.limits.max_velocity, ElementsAre(4, 5, 6));
  EXPECT_THAT(root.limits.max_acceleration, ElementsAre(7, 8, 9));
  EXPECT_THAT(root.stiffness, ElementsAre(0.5, 1.5, 2.5));
  EXPECT_EQ(root.link_length_m, 0.25);
  EXPECT_EQ(root.link_direction, Eigen::Vector3d::UnitY());
  EXPECT_EQ(root.link_mass_kg, 12);
  EXPECT_EQ(root.link_center_of_mass.z(), 0.125);
  const Joint& ball = skeleton->joint(1);
  EXPECT_EQ(ball.parent_id, "root");
  EXPECT_EQ(ball.parent_from_joint.translation.x(), 0.5);
  EXPECT_EQ(ball.parent_from_joint.rotation.y(), 0.6);
  EXPECT_EQ(ball.limits.swing_cone_rad, 1);
  EXPECT_EQ(ball.limits.twist_lower_rad, -0.5);
  EXPECT_EQ(ball.limits.twist_upper_rad, 0.75);
  const Joint& follower = skeleton->joint(3);
  EXPECT_EQ(follower.mimic->joint_id, "hinge");
  EXPECT_EQ(follower.mimic->multiplier, -0.5);
  EXPECT_EQ(follower.mimic->offset, 0.125);
  EXPECT_EQ(skeleton->end_effectors()[0].joint_id, "follower");
  EXPECT_EQ(skeleton->up(), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(skeleton->rest_positions()[7], 0.4);
}

TEST(ConvertSkeletonTest, ComesRound) {
  const v1::Skeleton once = ThereAndBack(Everything());
  EXPECT_EQ(once.position_count(), 8);
  EXPECT_EQ(once.velocity_count(), 7);
  EXPECT_THAT(once.position_offsets(), ElementsAre(0, 3, 7, -1));
  EXPECT_EQ(ThereAndBack(once).DebugString(), once.DebugString());
}

// Whatever was set is there again with the same value.
TEST(ConvertSkeletonTest, LosesNothing) {
  v1::Skeleton before = Everything();
  before.clear_dimension();  // kept by who stores it
  google::protobuf::util::MessageDifferencer differencer;
  differencer.set_scope(google::protobuf::util::MessageDifferencer::PARTIAL);
  std::string differences;
  differencer.ReportDifferencesToString(&differences);
  EXPECT_TRUE(differencer.Compare(before, ThereAndBack(before))) << differences;
}

TEST(ConvertSkeletonTest, RandomTreesMoveTheSameAfterwards) {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    const auto skeleton = RandomSkeleton(random);
    v1::Skeleton proto;
    ToProto(*skeleton, &proto);
    v1::Skeleton sent;
    ASSERT_TRUE(sent.ParseFromString(proto.SerializeAsString()));
    const auto again = FromProto(sent);
    ASSERT_TRUE(again.ok()) << again.status();
    const Eigen::VectorXd positions = RandomPose(random, *skeleton);
    WorldTransforms expected, actual;
    ForwardKinematics(*skeleton, positions, expected);
    ForwardKinematics(**again, positions, actual);
    ASSERT_EQ(actual.size(), expected.size());
    for (size_t j = 0; j < expected.size(); ++j) {
      EXPECT_EQ(actual[j].translation, expected[j].translation);
      EXPECT_EQ(actual[j].rotation.coeffs(), expected[j].rotation.coeffs());
    }
    v1::Skeleton twice;
    ToProto(**again, &twice);
    EXPECT_EQ(twice.SerializeAsString(), proto.SerializeAsString());
  }
}

TEST(ConvertSkeletonTest, EveryTypeComesRound) {
  for (int type = v1::JOINT_TYPE_FIXED; type <= v1::JOINT_TYPE_FREE; ++type) {
    v1::Skeleton proto;
    v1::Joint* joint = proto.add_joints();
    joint->set_joint_id("only");
    joint->set_type(static_cast<v1::JointType>(type));
    joint->mutable_axis()->set_z(1);
    EXPECT_EQ(ThereAndBack(proto).joints(0).type(), type);
  }
}

TEST(ConvertSkeletonTest, NamesEveryViolation) {
  v1::Skeleton proto = Everything();
  proto.mutable_joints(0)->set_type(v1::JOINT_TYPE_UNSPECIFIED);
  proto.mutable_joints(1)
      ->mutable_parent_from_joint()
      ->mutable_rotation()
      ->set_w(3);
  proto.mutable_joints(2)->clear_axis();
  proto.mutable_end_effectors(0)->set_joint_id("nobody");
  EXPECT_THAT(ViolationLines(FromProto(proto).status()),
              ::testing::IsSupersetOf(
                  {StartsWith("joints[0].type: no such joint type: 0"),
                   StartsWith("joints[1].parent_from_joint.rotation: "),
                   StartsWith("joints[2].axis: "),
                   StartsWith("end_effectors[0].joint_id: ")}));
}

TEST(ConvertSkeletonTest, RefusesTypesOfTheFuture) {
  v1::Skeleton proto = Everything();
  proto.mutable_joints(0)->set_type(static_cast<v1::JointType>(77));
  EXPECT_THAT(ViolationLines(FromProto(proto).status()),
              ::testing::Contains(
                  StartsWith("joints[0].type: no such joint type: 77")));
}

TEST(ConvertSkeletonTest, HoldsItsBounds) {
  SkeletonBounds bounds;
  bounds.max_joints = 4;
  EXPECT_TRUE(FromProto(Everything(), bounds).ok());
  bounds.max_joints = 3;
  EXPECT_FALSE(FromProto(Everything(), bounds).ok());
}

TEST(ConvertSkeletonTest, PlanarOnesStayInThePlane) {
  v1::Skeleton proto = Everything();
  proto.set_dimension(v1::DIMENSION_PLANAR);
  EXPECT_FALSE(FromProto(proto).ok());
}

// --- Files ---

TEST(SkeletonJsonTest, ComesRound) {
  v1::Skeleton proto;
  ToProto(*gelenk::testing::PersonWithFingers(), &proto);
  proto.set_name("skeletons/person");
  proto.set_display_name("Person");
  proto.add_warnings("guessed");
  const auto again = SkeletonFromJson(SkeletonToJson(proto));
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->SerializeAsString(), proto.SerializeAsString())
      << "numbers come round exactly";
}

TEST(SkeletonJsonTest, ReadsWhatPeopleWrite) {
  const auto proto = SkeletonFromJson(R"json({
    "displayName": "Arm",
    "joints": [
      {"jointId": "j0", "type": "JOINT_TYPE_REVOLUTE", "axis": {"z": 1}},
      {"joint_id": "j1", "parent_joint_id": "j0", "type": 2,
       "axis": {"z": 1}, "parentFromJoint": {"translation": {"x": 0.5}}}
    ]
  })json");
  ASSERT_TRUE(proto.ok()) << proto.status();
  EXPECT_EQ(FromProto(*proto).value()->joint_count(), 2);
}

TEST(SkeletonJsonTest, RefusesUnknownFields) {
  const auto proto = SkeletonFromJson(R"({"jonts": []})");
  EXPECT_EQ(proto.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(proto.status().message()), HasSubstr("jonts"));
  EXPECT_FALSE(
      SkeletonFromJson(R"({"joints": [{"jointId": "j0", "colour": "red"}]})")
          .ok());
}

TEST(SkeletonJsonTest, RefusesWhatIsNoJson) {
  for (const char* json : {"", "{", "[]", "HIERARCHY", "{\"joints\": 3}",
                           "{\"joints\": [{\"type\": \"JOINT_TYPE_SOFT\"}]}"}) {
    EXPECT_EQ(SkeletonFromJson(json).status().code(),
              absl::StatusCode::kInvalidArgument)
        << json;
  }
}

}  // namespace
}  // namespace gelenk::convert
