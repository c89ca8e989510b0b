#include "gelenk/retarget/joint_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "absl/strings/match.h"
#include "gelenk/retarget/humanoid.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/rig_family.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using testing::BodyOf;
using testing::RigFamilies;
using testing::RigFamily;

std::string JointOf(const JointMap& map, const Skeleton& skeleton,
                    BodyRole role) {
  const int joint = map.joint(role);
  return joint < 0 ? "" : skeleton.joint(joint).id;
}

void ExpectSide(const JointMap& map, const Skeleton& skeleton,
                const std::array<std::string, 8>& names, int side) {
  const ArmRoles& arm = kArmRoles[side];
  const LegRoles& leg = kLegRoles[side];
  const std::array<BodyRole, 8> roles = {
      arm.clavicle, arm.upper_arm, arm.forearm, arm.hand,
      leg.thigh,    leg.shin,      leg.foot,    leg.toe};
  for (size_t i = 0; i < roles.size(); ++i) {
    EXPECT_EQ(JointOf(map, skeleton, roles[i]), names[i])
        << BodyRoleName(roles[i]);
  }
}

TEST(JointMapTest, FindsEveryRoleOfEveryFamily) {
  for (const RigFamily& family : RigFamilies()) {
    SCOPED_TRACE(family.family);
    const auto skeleton = BodyOf(family);
    const auto map = ProposeJointMap(*skeleton);
    ASSERT_TRUE(map.ok()) << map.status();
    EXPECT_EQ(JointOf(*map, *skeleton, BodyRole::kPelvis), family.pelvis);
    EXPECT_EQ(JointOf(*map, *skeleton, BodyRole::kChest), family.spine.back());
    EXPECT_EQ(JointOf(*map, *skeleton, BodyRole::kNeck), family.neck.front());
    EXPECT_EQ(JointOf(*map, *skeleton, BodyRole::kHead), family.head);
    ExpectSide(*map, *skeleton, family.left, kLeft);
    ExpectSide(*map, *skeleton, family.right, kRight);
    EXPECT_EQ(map->spine.size(), family.spine.size());
    EXPECT_GT(map->Confidence(), family.family == "nameless" ? 0.5 : 0.85);
    if (family.family == "nameless") {
      EXPECT_LT(map->Confidence(), 0.75);
    }
  }
}

// `body` with a joint half way along every bone of its limbs.
std::shared_ptr<const Skeleton> WithTwistBones(const Skeleton& body,
                                               const RigFamily& family) {
  SkeletonBuilder builder;
  for (Joint joint : body.joints()) {
    for (const auto* names : {&family.left, &family.right}) {
      for (const size_t bone : {1, 2, 4, 5}) {
        if (joint.parent_id != (*names)[bone] ||
            joint.id != (*names)[bone + 1]) {
          continue;
        }
        Joint twist = joint;
        twist.id =
            joint.parent_id + (family.family == "nameless" ? "b" : "_twist");
        twist.parent_from_joint.translation /= 2;
        joint.parent_id = twist.id;
        joint.parent_from_joint.translation /= 2;
        builder.AddJoint(twist);
      }
    }
    builder.AddJoint(joint);
  }
  for (const EndEffector& end : body.end_effectors()) {
    builder.AddEndEffector(end);
  }
  return *builder.Build();
}

TEST(JointMapTest, TwistBonesAreNoLimbs) {
  for (const RigFamily& family : RigFamilies()) {
    SCOPED_TRACE(family.family);
    const auto body = BodyOf(family);
    const auto skeleton = WithTwistBones(*body, family);
    ASSERT_EQ(skeleton->joint_count(), body->joint_count() + 8);
    const auto map = ProposeJointMap(*skeleton);
    ASSERT_TRUE(map.ok()) << map.status();
    ExpectSide(*map, *skeleton, family.left, kLeft);
    ExpectSide(*map, *skeleton, family.right, kRight);
  }
}

// Some conversions have joints without length where limbs leave the trunk.
TEST(JointMapTest, AHelperInTheTrunkIsNoLimb) {
  const RigFamily& family = RigFamilies().back();
  ASSERT_EQ(family.family, "nameless");
  SkeletonBuilder builder;
  const auto body = BodyOf(family);
  for (Joint joint : body->joints()) {
    if (joint.id == family.left[4] || joint.id == family.right[4]) {
      Joint helper = joint;
      helper.id = joint.id + "h";
      helper.parent_from_joint.translation.setZero();
      joint.parent_id = helper.id;
      builder.AddJoint(helper);
    }
    // A short thigh: with the way to the hip it is as long as the shin.
    if (joint.id == family.left[5] || joint.id == family.right[5]) {
      joint.parent_from_joint.translation *= 0.75;
    }
    builder.AddJoint(joint);
  }
  const auto skeleton = *builder.Build();
  const auto map = ProposeJointMap(*skeleton);
  ASSERT_TRUE(map.ok()) << map.status();
  EXPECT_EQ(JointOf(*map, *skeleton, BodyRole::kLeftThigh), family.left[4]);
  EXPECT_EQ(JointOf(*map, *skeleton, BodyRole::kRightThigh), family.right[4]);
}

TEST(JointMapTest, OverridesWinAndMayTakeRolesAway) {
  const auto skeleton = MakeHumanoid();
  const auto map = ProposeJointMap(
      *skeleton, {{"chest", "chest"}, {"left_toe", ""}, {"head", "neck"}});
  ASSERT_TRUE(map.ok()) << map.status();
  EXPECT_EQ(JointOf(*map, *skeleton, BodyRole::kChest), "chest");
  EXPECT_EQ(map->roles[IndexOf(BodyRole::kChest)].evidence,
            RoleEvidence::kOverride);
  EXPECT_FALSE(map->Has(BodyRole::kLeftToe));
  EXPECT_TRUE(map->Has(BodyRole::kRightToe));
  EXPECT_EQ(JointOf(*map, *skeleton, BodyRole::kHead), "neck");
  EXPECT_THAT(map->notes,
              ::testing::Contains(::testing::HasSubstr("left_toe")));
}

TEST(JointMapTest, ABodyWithoutArmsHasTheRest) {
  const auto whole = BodyOf(RigFamilies()[0]);
  SkeletonBuilder builder;
  for (const Joint& joint : whole->joints()) {
    if (absl::StrContains(joint.id, "Arm") ||
        absl::StrContains(joint.id, "Hand") ||
        absl::StrContains(joint.id, "Shoulder")) {
      continue;
    }
    builder.AddJoint(joint);
  }
  const auto skeleton = *builder.Build();
  const auto map = ProposeJointMap(*skeleton);
  ASSERT_TRUE(map.ok()) << map.status();
  EXPECT_TRUE(map->HasLegs());
  EXPECT_FALSE(map->HasArm(kLeft));
  EXPECT_EQ(JointOf(*map, *skeleton, BodyRole::kHead), "mixamorig:Head");
  EXPECT_FALSE(map->Has(BodyRole::kChest));
  // Spine and neck are one chain.
  EXPECT_EQ(map->neck.size(), 4);
  EXPECT_THAT(map->notes,
              ::testing::Contains(::testing::HasSubstr("left_hand")));
}

TEST(JointMapTest, ListsEveryBadOverride) {
  const absl::Status status =
      ProposeJointMap(*MakeHumanoid(), {{"tail", "head"},
                                        {"head", "horn"},
                                        {"neck", "neck"},
                                        {"neck", "head"},
                                        {"chest", "neck"}})
          .status();
  for (const char* words :
       {"overrides[0].role", "overrides[1].joint_id", "overrides[3].role",
        "overrides[4].joint_id", "tail", "horn"}) {
    EXPECT_THAT(status,
                testing::Fails(absl::StatusCode::kInvalidArgument, words));
  }
}

TEST(JointMapTest, AMapComesBackFromItsEntries) {
  const auto skeleton = BodyOf(RigFamilies()[0]);
  const auto map = ProposeJointMap(*skeleton);
  ASSERT_TRUE(map.ok());
  std::vector<JointMapOverride> overrides;
  for (const JointMapEntry& entry : EntriesOf(*map, *skeleton)) {
    overrides.push_back({entry.role, entry.joint_id});
  }
  const auto again = ProposeJointMap(*skeleton, overrides);
  ASSERT_TRUE(again.ok()) << again.status();
  for (int i = 0; i < kBodyRoleCount; ++i) {
    EXPECT_EQ(again->roles[i].joint, map->roles[i].joint);
  }
  EXPECT_EQ(again->spine, map->spine);
  EXPECT_EQ(again->neck, map->neck);
}

TEST(JointMapTest, AHumanoidsOwnWordIsTakenExactly) {
  // A VRM file may name what the joints' names deny.
  const auto skeleton = BodyOf(RigFamilies().back());
  const std::vector<std::pair<std::string, std::string>> bones = {
      {"hips", "j0"},       {"chest", "j2"},          {"upperChest", "j3"},
      {"head", "j5"},       {"leftUpperArm", "j21"},  {"leftLowerArm", "j22"},
      {"leftHand", "j23"},  {"leftUpperLeg", "j14"},  {"leftLowerLeg", "j15"},
      {"leftFoot", "j16"},  {"rightUpperLeg", "j24"}, {"rightLowerLeg", "j25"},
      {"rightFoot", "j26"}, {"leftEye", "j4"}};
  const auto map = ProposeJointMap(*skeleton, OverridesOfHumanoid(bones));
  ASSERT_TRUE(map.ok()) << map.status();
  EXPECT_EQ(JointOf(*map, *skeleton, BodyRole::kChest), "j3");
  EXPECT_EQ(JointOf(*map, *skeleton, BodyRole::kLeftUpperArm), "j21");
  EXPECT_FALSE(map->Has(BodyRole::kRightHand));
  EXPECT_FALSE(map->Has(BodyRole::kLeftToe));
  EXPECT_FALSE(map->HasArm(kRight));
}

}  // namespace
}  // namespace gelenk
