#include "gelenk/motion/body_parts.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "gelenk/motion/body_part_name.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {
namespace {

struct Named {
  const char* name;
  BodySide side;
  BodyPart part;
};

TEST(BodyPartNameTest, KnowsTheFamiliesOfNames) {
  using enum BodyPart;
  constexpr BodySide kL = BodySide::kLeft;
  constexpr BodySide kR = BodySide::kRight;
  constexpr BodySide kNo = BodySide::kNone;
  const Named cases[] = {
      {"LeftHand", kL, kHand},
      {"RightHand", kR, kHand},
      {"lHand", kL, kHand},
      {"rHand", kR, kHand},
      {"hand_l", kL, kHand},
      {"hand.R", kR, kHand},
      {"Hand.L", kL, kHand},
      {"L_Hand", kL, kHand},
      {"mixamorig:LeftHand", kL, kHand},
      {"mixamorig_RightHand", kR, kHand},
      {"Character|rig|LeftHand", kL, kHand},
      {"Bip01 L Hand", kL, kHand},
      {"Bip001 R Hand", kR, kHand},
      {"LeftWrist", kL, kHand},
      {"LWrist", kL, kHand},
      {"RWRIST", kR, kHand},
      {"HandLeft", kL, kHand},
      {"lefthand", kL, kHand},
      {"righthand", kR, kHand},
      {"DEF-hand.L", kL, kHand},
      {"J_Bip_R_Hand", kR, kHand},
      {"LHAND", kL, kHand},
      {"lFoot", kL, kFoot},
      {"LeftAnkle", kL, kFoot},
      {"foot.L", kL, kFoot},
      {"RightFoot", kR, kFoot},
      {"Bip01 R Foot", kR, kFoot},
      {"AnkleRight", kR, kFoot},
      {"rfoot", kR, kFoot},
      {"Head", kNo, kHead},
      {"head", kNo, kHead},
      {"mixamorig:Head", kNo, kHead},
      {"Bip01 Head", kNo, kHead},
      {"J_Bip_C_Head", kNo, kHead},
      {"Hips", kNo, kHips},
      {"hip", kNo, kHips},
      {"pelvis", kNo, kHips},
      {"Bip01 Pelvis", kNo, kHips},
      {"root", kNo, kRoot},
  };
  for (const Named& c : cases) {
    const BodyPartName name = ReadBodyPartName(c.name);
    EXPECT_EQ(name.side, c.side) << c.name;
    EXPECT_EQ(name.part, c.part) << c.name;
  }
}

TEST(BodyPartNameTest, TakesNothingForWhatIsNearIt) {
  for (const char* name : {"LeftHandThumb1",
                           "LeftInHandIndex",
                           "RightHandMiddle3",
                           "LeftHand_End",
                           "RightHandEnd",
                           "LeftFingerBase",
                           "LThumb",
                           "rMid1",
                           "LeftHandProp",
                           "ik_hand_l",
                           "LeftToeBase",
                           "LeftForeFoot",
                           "RightForeFoot",
                           "RightToe",
                           "Bip01 L Toe0",
                           "ball_l",
                           "Head_end",
                           "HeadTop_End",
                           "LeftEye",
                           "LHipJoint",
                           "LeftHip",
                           "LeftUpLeg",
                           "rButtock",
                           "lForeArm",
                           "LeftHand.Xrotation",
                           "Handle",
                           "Hand",
                           "foot",
                           "Spine1",
                           "Neck",
                           "",
                           "手首"}) {
    EXPECT_EQ(ReadBodyPartName(name).part, BodyPart::kOther) << name;
  }
}

TEST(BodyPartNameTest, KnowsSidesInOtherNames) {
  EXPECT_EQ(ReadBodyPartName("LeftUpLeg").side, BodySide::kLeft);
  EXPECT_EQ(ReadBodyPartName("rShldr").side, BodySide::kRight);
  EXPECT_EQ(ReadBodyPartName("左手首").side, BodySide::kLeft);
  EXPECT_EQ(ReadBodyPartName("Spine").side, BodySide::kNone);
  EXPECT_EQ(ReadBodyPartName("leg").side, BodySide::kNone);
}

struct Bone {
  const char* id;
  const char* parent;
  double x, y, z;
};

std::shared_ptr<const Skeleton> Build(const std::vector<Bone>& bones) {
  SkeletonBuilder builder;
  for (const Bone& bone : bones) {
    Joint joint;
    joint.id = bone.id;
    joint.parent_id = bone.parent;
    joint.type = JointType::kSpherical;
    joint.parent_from_joint.translation = {bone.x, bone.y, bone.z};
    builder.AddJoint(joint);
  }
  const auto skeleton = builder.Build();
  EXPECT_TRUE(skeleton.ok()) << skeleton.status();
  return *skeleton;
}

// Left is +X, up +Y, forward +Z.
const std::vector<Bone> kNameless = {
    {"xa", "", 0, 0.9, 0},          // hips
    {"xb", "xa", -0.1, -0.05, 0},   // right leg
    {"xc", "xb", 0, -0.40, 0},      //
    {"xd", "xc", 0, -0.42, 0},      // right foot
    {"xe", "xd", 0, -0.05, 0.15},   //
    {"xf", "xa", 0.1, -0.05, 0},    // left leg
    {"xg", "xf", 0, -0.40, 0},      //
    {"xh", "xg", 0, -0.42, 0},      // left foot
    {"xi", "xh", 0, -0.05, 0.15},   //
    {"xj", "xa", 0, 0.2, 0},        // spine
    {"xk", "xj", 0, 0.3, 0},        // chest
    {"xl", "xk", 0.15, 0.05, 0},    // left arm
    {"xm", "xl", 0.28, 0, 0},       //
    {"xn", "xm", 0.25, 0, 0},       // left hand
    {"xo", "xn", 0.09, 0, 0.02},    //
    {"xp", "xn", 0.09, 0, -0.02},   //
    {"xq", "xk", -0.15, 0.05, 0},   // right arm
    {"xr", "xq", -0.28, 0, 0},      //
    {"xs", "xr", -0.25, 0, 0},      // right hand
    {"xt", "xs", -0.09, 0, 0.02},   //
    {"xu", "xs", -0.09, 0, -0.02},  //
    {"xv", "xk", 0, 0.12, 0},       // neck
    {"xw", "xv", 0, 0.1, 0.02},     // head
    {"xx", "xw", 0.03, 0.06, 0.1},  // eyes
    {"xy", "xw", -0.03, 0.06, 0.1},
};

TEST(BodyPartsTest, FindsABodyByItsShape) {
  const auto skeleton = Build(kNameless);
  const BodyParts parts = FindBodyParts(*skeleton);
  EXPECT_EQ(parts.evidence, BodyParts::Evidence::kShape);
  EXPECT_TRUE(parts.IsComplete());
  EXPECT_EQ(skeleton->joint(parts.hips).id, "xa");
  EXPECT_EQ(skeleton->joint(parts.left_hand).id, "xn");
  EXPECT_EQ(skeleton->joint(parts.right_hand).id, "xs");
  EXPECT_EQ(skeleton->joint(parts.left_foot).id, "xh");
  EXPECT_EQ(skeleton->joint(parts.right_foot).id, "xd");
  EXPECT_EQ(skeleton->joint(parts.head).id, "xw");
}

TEST(BodyPartsTest, LongCollarBonesAreNoUpperArms) {
  std::vector<Bone> bones = kNameless;
  for (Bone& bone : bones) {
    if (std::string(bone.id) == "xl") bone.x = 0.27;
    if (std::string(bone.id) == "xq") bone.x = -0.27;
  }
  const auto skeleton = Build(bones);
  const BodyParts parts = FindBodyParts(*skeleton);
  EXPECT_EQ(skeleton->joint(parts.left_hand).id, "xn");
  EXPECT_EQ(skeleton->joint(parts.right_hand).id, "xs");
}

TEST(BodyPartsTest, AWristOfScalarJointsEndsInItsLast) {
  SkeletonBuilder builder;
  for (Bone bone : kNameless) {
    Joint joint;
    joint.id = bone.id;
    joint.parent_id = bone.parent;
    joint.type = JointType::kSpherical;
    joint.parent_from_joint.translation = {bone.x, bone.y, bone.z};
    if (joint.id == "xn" || joint.id == "xs") {
      // First about one axis, then about another on the same spot.
      Joint before = joint;
      before.id += ".Xrotation";
      before.type = JointType::kRevolute;
      builder.AddJoint(before);
      joint.parent_id = before.id;
      joint.type = JointType::kRevolute;
      joint.parent_from_joint.translation.setZero();
    }
    builder.AddJoint(joint);
  }
  const auto skeleton = builder.Build();
  ASSERT_TRUE(skeleton.ok()) << skeleton.status();
  const BodyParts parts = FindBodyParts(**skeleton);
  EXPECT_EQ((*skeleton)->joint(parts.left_hand).id, "xn");
  EXPECT_EQ((*skeleton)->joint(parts.right_hand).id, "xs");
}

TEST(BodyPartsTest, SidesInNamesGoBeforeTheShape) {
  std::vector<Bone> bones = kNameless;
  for (Bone& bone : bones) {
    // The body looks along -Z: what the shape calls left is right.
    if (std::string(bone.id) == "xb") bone.id = "L1";
    if (std::string(bone.parent) == "xb") bone.parent = "L1";
    if (std::string(bone.id) == "xq") bone.id = "L2";
    if (std::string(bone.parent) == "xq") bone.parent = "L2";
  }
  const auto skeleton = Build(bones);
  const BodyParts parts = FindBodyParts(*skeleton);
  EXPECT_EQ(skeleton->joint(parts.left_hand).id, "xs");
  EXPECT_EQ(skeleton->joint(parts.left_foot).id, "xd");
}

TEST(BodyPartsTest, FindsABodyByItsNames) {
  std::vector<Bone> bones = kNameless;
  const std::vector<std::pair<std::string, const char*>> names = {
      {"xa", "Hips"},     {"xd", "RightFoot"}, {"xh", "LeftFoot"},
      {"xn", "LeftHand"}, {"xs", "RightHand"}, {"xw", "Head"}};
  for (Bone& bone : bones) {
    for (const auto& [from, to] : names) {
      if (bone.id == from) bone.id = to;
      if (bone.parent == from) bone.parent = to;
    }
  }
  const auto skeleton = Build(bones);
  const BodyParts parts = FindBodyParts(*skeleton);
  EXPECT_EQ(parts.evidence, BodyParts::Evidence::kNames);
  EXPECT_EQ(parts.left_hand, skeleton->FindJoint("LeftHand"));
  EXPECT_EQ(parts.right_hand, skeleton->FindJoint("RightHand"));
  EXPECT_EQ(parts.left_foot, skeleton->FindJoint("LeftFoot"));
  EXPECT_EQ(parts.right_foot, skeleton->FindJoint("RightFoot"));
  EXPECT_EQ(parts.hips, 0);
  EXPECT_EQ(parts.head, skeleton->FindJoint("Head"));
}

TEST(BodyPartsTest, NamesWithoutAHeadGetItFromTheShape) {
  std::vector<Bone> bones = kNameless;
  const std::vector<std::pair<std::string, const char*>> names = {
      {"xd", "RightAnkle"},
      {"xh", "LeftAnkle"},
      {"xn", "LeftWrist"},
      {"xs", "RightWrist"}};
  for (Bone& bone : bones) {
    for (const auto& [from, to] : names) {
      if (bone.id == from) bone.id = to;
      if (bone.parent == from) bone.parent = to;
    }
  }
  const auto skeleton = Build(bones);
  const BodyParts parts = FindBodyParts(*skeleton);
  EXPECT_EQ(parts.evidence, BodyParts::Evidence::kNamesAndShape);
  EXPECT_EQ(skeleton->joint(parts.head).id, "xw");
  EXPECT_EQ(skeleton->joint(parts.hips).id, "xa");
}

TEST(BodyPartsTest, AChainIsNoBody) {
  const auto skeleton =
      Build({{"a", "", 0, 0, 0}, {"b", "a", 1, 0, 0}, {"c", "b", 1, 0, 0}});
  const BodyParts parts = FindBodyParts(*skeleton);
  EXPECT_FALSE(parts.IsComplete());
  EXPECT_EQ(parts.evidence, BodyParts::Evidence::kNone);
  EXPECT_EQ(parts.left_hand, -1);
}

}  // namespace
}  // namespace gelenk
