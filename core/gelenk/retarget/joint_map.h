// Which joint of a skeleton plays which role of a body.
//
// Ends (hands, feet, head) are told by names where they say it, else by shape
// (motion/body_parts.h); everything between them by topology, lengths and names
// together (limb_finder.h), because the same name means different joints on
// different rigs. What was guessed is told with a confidence, and every entry
// can be overridden by name. Roles may be missing: what hangs on them is then
// not retargeted.
#ifndef GELENK_RETARGET_JOINT_MAP_H_
#define GELENK_RETARGET_JOINT_MAP_H_

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/retarget/body_role.h"
#include "gelenk/retarget/clip_view.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

enum class RoleEvidence { kNone, kNames, kTopology, kShape, kOverride };
absl::string_view RoleEvidenceName(RoleEvidence evidence);

struct RoleAssignment {
  int joint = -1;
  // 0 to 1: how sure the proposal is. 1 for overrides.
  double confidence = 0;
  RoleEvidence evidence = RoleEvidence::kNone;
};

struct JointMap {
  std::array<RoleAssignment, kBodyRoleCount> roles;
  // From below the pelvis to the chest, both in order; the chest is the last.
  std::vector<int> spine;
  // From below the chest to above the head.
  std::vector<int> neck;
  // What people should know: roles that are missing and why.
  std::vector<std::string> notes;

  int joint(BodyRole role) const { return roles[IndexOf(role)].joint; }
  bool Has(BodyRole role) const { return joint(role) >= 0; }
  bool HasLeg(int side) const;
  bool HasArm(int side) const;
  bool HasLegs() const { return HasLeg(kLeft) && HasLeg(kRight); }
  // The least confidence of the roles that are there; 0 without any.
  double Confidence() const;
};

// One line of a map, by names; what the wire and files carry.
struct JointMapEntry {
  std::string role;
  std::string joint_id;
  double confidence = 0;
  std::string evidence;
};

// The user's word: `role` is played by `joint_id`, or by nobody when that is
// empty.
struct JointMapOverride {
  std::string role;
  std::string joint_id;
};

// The roles that are there, in the order of BodyRole.
std::vector<JointMapEntry> EntriesOf(const JointMap& map,
                                     const Skeleton& skeleton);

// Where no name tells left from right, `clip` (may be null) does: in motion
// toes point forward. Errors: INVALID_ARGUMENT listing overrides[i] whose role
// or joint is unknown, that come twice, or that give one joint two roles. Cost:
// that of FindBodyParts, and of 100 frames.
absl::StatusOr<JointMap> ProposeJointMap(
    const Skeleton& skeleton, absl::Span<const JointMapOverride> overrides = {},
    const ClipView* clip = nullptr);

// A humanoid's own word, as VRM files and Unity avatars carry it: bone name and
// joint id. Roles that it does not name are nobody's. Bones without a role are
// skipped.
std::vector<JointMapOverride> OverridesOfHumanoid(
    absl::Span<const std::pair<std::string, std::string>> joint_of_bone);

}  // namespace gelenk

#endif  // GELENK_RETARGET_JOINT_MAP_H_
