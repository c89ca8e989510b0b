#include "gelenk/retarget/body_role.h"

#include "absl/strings/match.h"

namespace gelenk {
namespace {

constexpr std::array<absl::string_view, kBodyRoleCount> kNames = {
    "pelvis",         "chest",           "neck",          "head",
    "left_clavicle",  "left_upper_arm",  "left_forearm",  "left_hand",
    "right_clavicle", "right_upper_arm", "right_forearm", "right_hand",
    "left_thigh",     "left_shin",       "left_foot",     "left_toe",
    "right_thigh",    "right_shin",      "right_foot",    "right_toe"};

struct HumanoidBone {
  absl::string_view name;
  BodyRole role;
};
constexpr std::array<HumanoidBone, 21> kHumanoidBones = {
    {{"hips", BodyRole::kPelvis},
     {"chest", BodyRole::kChest},
     {"upperChest", BodyRole::kChest},
     {"neck", BodyRole::kNeck},
     {"head", BodyRole::kHead},
     {"leftShoulder", BodyRole::kLeftClavicle},
     {"leftUpperArm", BodyRole::kLeftUpperArm},
     {"leftLowerArm", BodyRole::kLeftForearm},
     {"leftHand", BodyRole::kLeftHand},
     {"rightShoulder", BodyRole::kRightClavicle},
     {"rightUpperArm", BodyRole::kRightUpperArm},
     {"rightLowerArm", BodyRole::kRightForearm},
     {"rightHand", BodyRole::kRightHand},
     {"leftUpperLeg", BodyRole::kLeftThigh},
     {"leftLowerLeg", BodyRole::kLeftShin},
     {"leftFoot", BodyRole::kLeftFoot},
     {"leftToes", BodyRole::kLeftToe},
     {"rightUpperLeg", BodyRole::kRightThigh},
     {"rightLowerLeg", BodyRole::kRightShin},
     {"rightFoot", BodyRole::kRightFoot},
     {"rightToes", BodyRole::kRightToe}}};

}  // namespace

absl::string_view BodyRoleName(BodyRole role) { return kNames[IndexOf(role)]; }

std::optional<BodyRole> FindBodyRole(absl::string_view name) {
  for (int i = 0; i < kBodyRoleCount; ++i) {
    if (kNames[i] == name) return static_cast<BodyRole>(i);
  }
  return std::nullopt;
}

std::optional<BodyRole> RoleOfHumanoidBone(absl::string_view bone) {
  for (const HumanoidBone& known : kHumanoidBones) {
    if (absl::EqualsIgnoreCase(known.name, bone)) return known.role;
  }
  return std::nullopt;
}

}  // namespace gelenk
