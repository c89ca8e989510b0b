#include "tests/testing/rig_family.h"

#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::testing {
namespace {

using Names = std::array<std::string, 8>;

// `pattern` with each of `parts` in the place of "*".
Names Named(const std::string& pattern, const Names& parts) {
  Names names;
  for (size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].empty()) continue;
    names[i] = pattern;
    names[i].replace(pattern.find('*'), 1, parts[i]);
  }
  return names;
}

const Names kMixamo = {"Shoulder", "Arm", "ForeArm", "Hand",
                       "UpLeg",    "Leg", "Foot",    "ToeBase"};

void AddJoint(const std::string& id, const std::string& parent,
              const Eigen::Vector3d& place, SkeletonBuilder& builder) {
  Joint joint;
  joint.id = id;
  joint.parent_id = parent;
  joint.type = parent.empty() ? JointType::kFree : JointType::kSpherical;
  joint.parent_from_joint.translation = place;
  builder.AddJoint(joint);
}

void AddTip(const std::string& joint, const Eigen::Vector3d& place,
            SkeletonBuilder& builder) {
  EndEffector end;
  end.id = joint + ".end";
  end.joint_id = joint;
  end.joint_from_end_effector.translation = place;
  builder.AddEndEffector(end);
}

void AddSide(const RigFamily& family, const Names& names, double out,
             SkeletonBuilder& builder) {
  const std::string& chest = family.spine.back();
  const Eigen::Vector3d shoulder(0.17 * out, 0.12, 0);
  const Eigen::Vector3d inner(0.04 * out, 0.12, 0);
  if (names[0].empty()) {
    AddJoint(names[1], chest, shoulder, builder);
  } else {
    AddJoint(names[0], chest, inner, builder);
    AddJoint(names[1], names[0], shoulder - inner, builder);
  }
  AddJoint(names[2], names[1], {0.28 * out, 0, 0}, builder);
  AddJoint(names[3], names[2], {0.26 * out, 0, 0}, builder);
  AddTip(names[3], {0.15 * out, 0, 0}, builder);
  AddJoint(names[4], family.pelvis, {0.09 * out, -0.04, 0}, builder);
  AddJoint(names[5], names[4], {0, -0.43, 0}, builder);
  AddJoint(names[6], names[5], {0, -0.42, 0}, builder);
  AddJoint(names[7], names[6], {0, -0.06, 0.13}, builder);
  AddTip(names[7], {0, 0, 0.07}, builder);
}

}  // namespace

const std::vector<RigFamily>& RigFamilies() {
  static const std::vector<RigFamily> kFamilies = {
      {"Mixamo",
       "mixamorig:Hips",
       {"mixamorig:Spine", "mixamorig:Spine1", "mixamorig:Spine2"},
       {"mixamorig:Neck"},
       "mixamorig:Head",
       Named("mixamorig:Left*", kMixamo),
       Named("mixamorig:Right*", kMixamo)},
      {"CMU (cgspeed)",
       "hip",
       {"abdomen", "chest"},
       {"neck"},
       "head",
       Named("l*", {"Collar", "Shldr", "ForeArm", "Hand", "Thigh", "Shin",
                    "Foot", "Toe"}),
       Named("r*", {"Collar", "Shldr", "ForeArm", "Hand", "Thigh", "Shin",
                    "Foot", "Toe"})},
      {"HumanIK",
       "Character1_Hips",
       {"Character1_Spine", "Character1_Spine1"},
       {"Character1_Neck"},
       "Character1_Head",
       Named("Character1_Left*", kMixamo),
       Named("Character1_Right*", kMixamo)},
      {"VRM",
       "J_Bip_C_Hips",
       {"J_Bip_C_Spine", "J_Bip_C_Chest", "J_Bip_C_UpperChest"},
       {"J_Bip_C_Neck"},
       "J_Bip_C_Head",
       Named("J_Bip_L_*", {"Shoulder", "UpperArm", "LowerArm", "Hand",
                           "UpperLeg", "LowerLeg", "Foot", "ToeBase"}),
       Named("J_Bip_R_*", {"Shoulder", "UpperArm", "LowerArm", "Hand",
                           "UpperLeg", "LowerLeg", "Foot", "ToeBase"})},
      {"Unity",
       "Hips",
       {"Spine", "Chest", "UpperChest"},
       {"Neck"},
       "Head",
       Named("Left*", {"Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg",
                       "LowerLeg", "Foot", "Toes"}),
       Named("Right*", {"Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg",
                        "LowerLeg", "Foot", "Toes"})},
      {"Rokoko",
       "Hips",
       {"Spine", "Spine2", "Spine4"},
       {"Neck"},
       "Head",
       Named("Left*", {"Shoulder", "Arm", "ForeArm", "Hand", "Thigh", "Shin",
                       "Foot", "Toe"}),
       Named("Right*", {"Shoulder", "Arm", "ForeArm", "Hand", "Thigh", "Shin",
                        "Foot", "Toe"})},
      {"Xsens",
       "Pelvis",
       {"L5", "L3", "T12", "T8"},
       {"Neck"},
       "Head",
       Named("Left*", {"Shoulder", "UpperArm", "ForeArm", "Hand", "UpperLeg",
                       "LowerLeg", "Foot", "Toe"}),
       Named("Right*", {"Shoulder", "UpperArm", "ForeArm", "Hand", "UpperLeg",
                        "LowerLeg", "Foot", "Toe"})},
      {"OptiTrack",
       "Skeleton_Hip",
       {"Skeleton_Ab", "Skeleton_Chest"},
       {"Skeleton_Neck"},
       "Skeleton_Head",
       Named("Skeleton_L*", {"Shoulder", "UArm", "FArm", "Hand", "Thigh",
                             "Shin", "Foot", "Toe"}),
       Named("Skeleton_R*", {"Shoulder", "UArm", "FArm", "Hand", "Thigh",
                             "Shin", "Foot", "Toe"})},
      {"Biped",
       "Bip01 Pelvis",
       {"Bip01 Spine", "Bip01 Spine1"},
       {"Bip01 Neck"},
       "Bip01 Head",
       Named("Bip01 L *", {"Clavicle", "UpperArm", "Forearm", "Hand", "Thigh",
                           "Calf", "Foot", "Toe0"}),
       Named("Bip01 R *", {"Clavicle", "UpperArm", "Forearm", "Hand", "Thigh",
                           "Calf", "Foot", "Toe0"})},
      {"SMPL",
       "Pelvis",
       {"Spine1", "Spine2", "Spine3"},
       {"Neck"},
       "Head",
       Named("L_*", {"Collar", "Shoulder", "Elbow", "Wrist", "Hip", "Knee",
                     "Ankle", "Foot"}),
       Named("R_*", {"Collar", "Shoulder", "Elbow", "Wrist", "Hip", "Knee",
                     "Ankle", "Foot"})},
      {"Rigify",
       "DEF-spine",
       {"DEF-spine.001", "DEF-spine.003"},
       {"DEF-spine.004"},
       "DEF-head",
       Named("DEF-*.L", {"shoulder", "upper_arm", "forearm", "hand", "thigh",
                         "shin", "foot", "toe"}),
       Named("DEF-*.R", {"shoulder", "upper_arm", "forearm", "hand", "thigh",
                         "shin", "foot", "toe"})},
      {"Unreal",
       "pelvis",
       {"spine_01", "spine_02", "spine_03"},
       {"neck_01"},
       "head",
       Named("*_l", {"clavicle", "upperarm", "lowerarm", "hand", "thigh",
                     "calf", "foot", "ball"}),
       Named("*_r", {"clavicle", "upperarm", "lowerarm", "hand", "thigh",
                     "calf", "foot", "ball"})},
      {"mocapbank, without collars",
       "Hips",
       {"Chest", "Chest2"},
       {"Neck"},
       "Head",
       Named("Left*",
             {"", "Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle", "Toe"}),
       Named("Right*", {"", "Shoulder", "Elbow", "Wrist", "Hip", "Knee",
                        "Ankle", "Toe"})},
      {"nameless",
       "j0",
       {"j1", "j2", "j3"},
       {"j4"},
       "j5",
       {"j10", "j11", "j12", "j13", "j14", "j15", "j16", "j17"},
       {"j20", "j21", "j22", "j23", "j24", "j25", "j26", "j27"}},
  };
  return kFamilies;
}

std::shared_ptr<const Skeleton> BodyOf(const RigFamily& family) {
  SkeletonBuilder builder;
  AddJoint(family.pelvis, "", {0, 0.97, 0}, builder);
  std::string parent = family.pelvis;
  for (const std::string& id : family.spine) {
    AddJoint(id, parent,
             {0, 0.36 / static_cast<double>(family.spine.size()), 0}, builder);
    parent = id;
  }
  Eigen::Vector3d place(0, 0.16, 0);
  for (const std::string& id : family.neck) {
    AddJoint(id, parent, place, builder);
    parent = id;
    place = {0, 0.1, 0};
  }
  AddJoint(family.head, parent, place, builder);
  AddTip(family.head, {0, 0.16, 0}, builder);
  AddSide(family, family.left, 1, builder);
  AddSide(family, family.right, -1, builder);
  return *builder.Build();
}

}  // namespace gelenk::testing
