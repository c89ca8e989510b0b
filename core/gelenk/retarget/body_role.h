// The parts of a body that mean the same on every rig.
#ifndef GELENK_RETARGET_BODY_ROLE_H_
#define GELENK_RETARGET_BODY_ROLE_H_

#include <array>
#include <optional>

#include "absl/strings/string_view.h"

namespace gelenk {

// Each is the joint at the beginning of its bone: the forearm's is the elbow,
// the hand's the wrist, the shin's the knee, the foot's the ankle, the toe's
// the ball of the foot. Left is the body's own.
enum class BodyRole : unsigned char {
  kPelvis,  // where the legs and the spine meet
  kChest,   // where the arms meet
  kNeck,
  kHead,
  kLeftClavicle,
  kLeftUpperArm,
  kLeftForearm,
  kLeftHand,
  kRightClavicle,
  kRightUpperArm,
  kRightForearm,
  kRightHand,
  kLeftThigh,
  kLeftShin,
  kLeftFoot,
  kLeftToe,
  kRightThigh,
  kRightShin,
  kRightFoot,
  kRightToe,
};
inline constexpr int kBodyRoleCount = 20;

constexpr int IndexOf(BodyRole role) { return static_cast<int>(role); }

// "pelvis", "left_upper_arm" ...
absl::string_view BodyRoleName(BodyRole role);
std::optional<BodyRole> FindBodyRole(absl::string_view name);

// Both sides of what a body has twice.
inline constexpr int kLeft = 0;
inline constexpr int kRight = 1;
inline constexpr std::array<int, 2> kSides = {kLeft, kRight};

struct ArmRoles {
  BodyRole clavicle, upper_arm, forearm, hand;
};
struct LegRoles {
  BodyRole thigh, shin, foot, toe;
};
inline constexpr std::array<ArmRoles, 2> kArmRoles = {
    {{BodyRole::kLeftClavicle, BodyRole::kLeftUpperArm, BodyRole::kLeftForearm,
      BodyRole::kLeftHand},
     {BodyRole::kRightClavicle, BodyRole::kRightUpperArm,
      BodyRole::kRightForearm, BodyRole::kRightHand}}};
inline constexpr std::array<LegRoles, 2> kLegRoles = {
    {{BodyRole::kLeftThigh, BodyRole::kLeftShin, BodyRole::kLeftFoot,
      BodyRole::kLeftToe},
     {BodyRole::kRightThigh, BodyRole::kRightShin, BodyRole::kRightFoot,
      BodyRole::kRightToe}}};

// The role of a bone of the VRM and Unity humanoid ("leftUpperArm", "hips",
// "LeftUpperLeg"); none for those that have no role here (fingers, eyes, jaw).
// Of "chest" and "upperChest" the chest is the one nearer to the arms: a rig
// that has both maps "upperChest".
std::optional<BodyRole> RoleOfHumanoidBone(absl::string_view bone);

}  // namespace gelenk

#endif  // GELENK_RETARGET_BODY_ROLE_H_
