#include "gelenk/retarget/joint_map.h"

#include <algorithm>
#include <optional>

#include <Eigen/Core>
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/motion/body_part_name.h"
#include "gelenk/motion/body_parts.h"
#include "gelenk/motion/body_shape.h"
#include "gelenk/retarget/limb_finder.h"
#include "gelenk/retarget/side_check.h"

namespace gelenk {
namespace {

// What a guess by shape, or a limb that scores 1, takes from certainty.
constexpr double kShapeDoubt = 0.3;
constexpr double kLimbDoubt = 0.2;
// Joints of one wrist or ankle are nearer than this part of the body's extent.
constexpr double kMaxGroupPart = 0.07;

// Whether the user has spoken, by role.
using Given = std::array<bool, kBodyRoleCount>;

class JointMapProposal {
 public:
  JointMapProposal(const Skeleton& skeleton, JointMap overridden,
                   const Given& given)
      : skeleton_(skeleton), map_(std::move(overridden)), given_(given) {
    WorldTransforms world_from_joints;
    ForwardKinematics(skeleton, skeleton.rest_positions(), world_from_joints);
    for (const RigidTransform& world_from_joint : world_from_joints) {
      points_.push_back(world_from_joint.translation);
      extent_ = std::max(extent_, (points_.back() - points_[0]).norm());
    }
  }

  JointMap Propose(const ClipView* clip) {
    TakeEnds();
    TakeTrunk();
    for (int side : kSides) {
      TakeLeg(kLegRoles[side]);
      TakeArm(kArmRoles[side]);
    }
    TakeSpine();
    TakeNeck();
    if (clip != nullptr && clip->frame_count() > 0) SettleSides(*clip);
    NoteMissing();
    return std::move(map_);
  }

 private:
  bool IsGiven(BodyRole role) const { return given_[IndexOf(role)]; }

  void Set(BodyRole role, int joint, double confidence, RoleEvidence evidence) {
    if (IsGiven(role) || joint < 0) return;
    map_.roles[IndexOf(role)] = {joint, std::clamp(confidence, 0.0, 1.0),
                                 evidence};
  }

  double ConfidenceOf(BodyRole role) const {
    return map_.roles[IndexOf(role)].confidence;
  }

  void TakeEnds() {
    const BodyParts parts = FindBodyParts(skeleton_);
    TakeEnd(BodyRole::kLeftFoot, parts.left_foot, BodyPart::kFoot);
    TakeEnd(BodyRole::kRightFoot, parts.right_foot, BodyPart::kFoot);
    TakeEnd(BodyRole::kLeftHand, parts.left_hand, BodyPart::kHand);
    TakeEnd(BodyRole::kRightHand, parts.right_hand, BodyPart::kHand);
    TakeEnd(BodyRole::kHead, parts.head, BodyPart::kHead);
    named_hips_ = parts.hips;
  }

  void TakeEnd(BodyRole role, int joint, BodyPart part) {
    if (joint < 0) return;
    const int end = LastOfGroup(joint);
    const bool is_named =
        ReadBodyPartName(skeleton_.joint(joint).id).part == part;
    Set(role, end, is_named ? 1 : 1 - kShapeDoubt,
        is_named ? RoleEvidence::kNames : RoleEvidence::kShape);
  }

  // Robots have wrists and ankles of several joints close together: the last
  // one moves the hand or the foot.
  int LastOfGroup(int joint) const {
    while (skeleton_.joint(joint).type == JointType::kRevolute) {
      int next = -1;
      for (int i = joint + 1; i < skeleton_.joint_count(); ++i) {
        if (skeleton_.span(i).parent != joint ||
            skeleton_.joint(i).type != JointType::kRevolute) {
          continue;
        }
        if (next >= 0) return joint;
        next = i;
      }
      if (next < 0 ||
          (points_[next] - points_[joint]).norm() > kMaxGroupPart * extent_) {
        return joint;
      }
      joint = next;
    }
    return joint;
  }

  // The joint in which both ends of a pair meet; that of one when the other is
  // missing.
  int Meeting(BodyRole left, BodyRole right) const {
    if (!map_.Has(left) || !map_.Has(right)) return -1;
    return CommonAncestor(skeleton_, map_.joint(left), map_.joint(right));
  }

  void TakeTrunk() {
    int chest = Meeting(BodyRole::kLeftHand, BodyRole::kRightHand);
    int pelvis = Meeting(BodyRole::kLeftFoot, BodyRole::kRightFoot);
    if (pelvis < 0) pelvis = named_hips_;
    if (IsGiven(BodyRole::kChest)) chest = map_.joint(BodyRole::kChest);
    if (chest < 0) chest = map_.joint(BodyRole::kHead) >= 0 ? pelvis : -1;
    // The trunk begins where the spine does.
    if (chest >= 0 && pelvis >= 0) {
      pelvis = CommonAncestor(skeleton_, pelvis, chest);
    }
    const auto least = [this](BodyRole a, BodyRole b) {
      return std::min(ConfidenceOf(a), ConfidenceOf(b));
    };
    Set(BodyRole::kPelvis, pelvis,
        pelvis == named_hips_
            ? 1
            : least(BodyRole::kLeftFoot, BodyRole::kRightFoot),
        RoleEvidence::kTopology);
    if (chest != map_.joint(BodyRole::kPelvis)) {
      Set(BodyRole::kChest, chest,
          least(BodyRole::kLeftHand, BodyRole::kRightHand),
          RoleEvidence::kTopology);
    }
  }

  // Gives the limb that ends at `end` its upper and middle joint.
  void TakeLimb(BodyRole top, BodyRole upper, BodyRole middle, BodyRole end,
                LimbKind kind) {
    if (!map_.Has(top) || !map_.Has(end)) return;
    if (IsGiven(upper) && IsGiven(middle)) return;
    const std::optional<LimbJoints> limb =
        FindLimb(skeleton_, points_, map_.joint(top), map_.joint(end), kind);
    if (!limb) {
      map_.notes.push_back(absl::StrFormat(
          "no two bones of a limb lead to %s \"%s\"", BodyRoleName(end),
          skeleton_.joint(map_.joint(end)).id));
      return;
    }
    const double confidence =
        ConfidenceOf(end) - kLimbDoubt * std::max(0.0, limb->score);
    Set(upper, limb->upper, confidence, RoleEvidence::kTopology);
    Set(middle, limb->middle, confidence, RoleEvidence::kTopology);
  }

  void TakeLeg(const LegRoles& leg) {
    TakeLimb(BodyRole::kPelvis, leg.thigh, leg.shin, leg.foot, LimbKind::kLeg);
    if (!map_.Has(leg.foot)) return;
    const int toe = ToeBelow(map_.joint(leg.foot));
    Set(leg.toe, toe, ConfidenceOf(leg.foot), RoleEvidence::kTopology);
  }

  // The first joint of the foot that moves, is elsewhere and is no heel; one
  // that is called toe or ball before others.
  int ToeBelow(int foot) const {
    int toe = -1;
    for (int i = foot + 1; i < skeleton_.joint_count(); ++i) {
      if (skeleton_.span(i).parent != foot) continue;
      if (skeleton_.joint(i).type == JointType::kFixed) continue;
      if ((points_[i] - points_[foot]).isZero()) continue;
      const std::string name = absl::AsciiStrToLower(skeleton_.joint(i).id);
      if (absl::StrContains(name, "heel")) continue;
      if (absl::StrContains(name, "toe") || absl::StrContains(name, "ball")) {
        return i;
      }
      if (toe < 0) toe = i;
    }
    return toe;
  }

  void TakeArm(const ArmRoles& arm) {
    const BodyRole top =
        map_.Has(BodyRole::kChest) ? BodyRole::kChest : BodyRole::kPelvis;
    TakeLimb(top, arm.upper_arm, arm.forearm, arm.hand, LimbKind::kArm);
    if (!map_.Has(arm.upper_arm)) return;
    const int above = skeleton_.span(map_.joint(arm.upper_arm)).parent;
    if (above == map_.joint(top) || above < 0) return;
    Set(arm.clavicle, above, ConfidenceOf(arm.upper_arm),
        RoleEvidence::kTopology);
  }

  void TakeSpine() {
    if (!map_.Has(BodyRole::kPelvis) || !map_.Has(BodyRole::kChest)) return;
    map_.spine = ChainBelow(skeleton_, map_.joint(BodyRole::kPelvis),
                            map_.joint(BodyRole::kChest));
  }

  void TakeNeck() {
    const BodyRole top =
        map_.Has(BodyRole::kChest) ? BodyRole::kChest : BodyRole::kPelvis;
    if (!map_.Has(top) || !map_.Has(BodyRole::kHead)) return;
    map_.neck =
        ChainBelow(skeleton_, map_.joint(top), map_.joint(BodyRole::kHead));
    if (map_.neck.empty()) {
      map_.notes.emplace_back("the head is not above the chest");
      map_.roles[IndexOf(BodyRole::kHead)] = {};
      return;
    }
    map_.neck.pop_back();
    if (map_.neck.empty()) return;
    Set(BodyRole::kNeck, map_.neck.front(), ConfidenceOf(BodyRole::kHead),
        RoleEvidence::kTopology);
  }

  // Where neither names nor the user say which side is which.
  void SettleSides(const ClipView& clip) {
    const SwappedSides swapped = CheckSides(skeleton_, map_, clip);
    if (swapped.legs) {
      Swap({{BodyRole::kLeftThigh, BodyRole::kRightThigh},
            {BodyRole::kLeftShin, BodyRole::kRightShin},
            {BodyRole::kLeftFoot, BodyRole::kRightFoot},
            {BodyRole::kLeftToe, BodyRole::kRightToe}});
    }
    if (swapped.arms) {
      Swap({{BodyRole::kLeftClavicle, BodyRole::kRightClavicle},
            {BodyRole::kLeftUpperArm, BodyRole::kRightUpperArm},
            {BodyRole::kLeftForearm, BodyRole::kRightForearm},
            {BodyRole::kLeftHand, BodyRole::kRightHand}});
    }
  }

  void Swap(absl::Span<const std::pair<BodyRole, BodyRole>> pairs) {
    for (const auto& [left, right] : pairs) {
      for (BodyRole role : {left, right}) {
        if (IsGiven(role)) return;
        if (map_.Has(role) &&
            ReadBodyPartName(skeleton_.joint(map_.joint(role)).id).side !=
                BodySide::kNone) {
          return;
        }
      }
    }
    for (const auto& [left, right] : pairs) {
      std::swap(map_.roles[IndexOf(left)], map_.roles[IndexOf(right)]);
    }
    map_.notes.push_back(absl::StrCat(
        BodyRoleName(pairs.back().first),
        " and its side are told by the motion: toes point forward"));
  }

  void NoteMissing() {
    std::string missing;
    for (int i = 0; i < kBodyRoleCount; ++i) {
      if (map_.roles[i].joint >= 0) continue;
      absl::StrAppend(&missing, missing.empty() ? "" : ", ",
                      BodyRoleName(static_cast<BodyRole>(i)));
    }
    if (!missing.empty()) {
      map_.notes.push_back(absl::StrCat("no joint for: ", missing));
    }
  }

  const Skeleton& skeleton_;
  JointMap map_;
  const Given& given_;
  std::vector<Eigen::Vector3d> points_;
  // The farthest joint from the root.
  double extent_ = 0;
  int named_hips_ = -1;
};

// The overrides as a map, and which roles they speak of.
absl::Status ReadOverrides(const Skeleton& skeleton,
                           absl::Span<const JointMapOverride> overrides,
                           JointMap& map, Given& given) {
  Violations violations;
  for (size_t i = 0; i < overrides.size(); ++i) {
    const std::string field = absl::StrCat("overrides[", i, "]");
    const std::optional<BodyRole> role = FindBodyRole(overrides[i].role);
    if (!role) {
      violations.Add(absl::StrCat(field, ".role"),
                     absl::StrCat("unknown role \"", overrides[i].role, "\""));
      continue;
    }
    if (given[IndexOf(*role)]) {
      violations.Add(absl::StrCat(field, ".role"),
                     absl::StrCat("\"", overrides[i].role, "\" comes twice"));
      continue;
    }
    given[IndexOf(*role)] = true;
    if (overrides[i].joint_id.empty()) continue;
    const int joint = skeleton.FindJoint(overrides[i].joint_id);
    if (joint < 0) {
      violations.Add(absl::StrCat(field, ".joint_id"),
                     absl::StrCat("no joint \"", overrides[i].joint_id, "\""));
      continue;
    }
    for (const RoleAssignment& other : map.roles) {
      if (other.joint == joint) {
        violations.Add(absl::StrCat(field, ".joint_id"),
                       absl::StrCat("\"", overrides[i].joint_id,
                                    "\" has another role already"));
      }
    }
    map.roles[IndexOf(*role)] = {joint, 1, RoleEvidence::kOverride};
  }
  return violations.ToStatus();
}

}  // namespace

absl::string_view RoleEvidenceName(RoleEvidence evidence) {
  switch (evidence) {
    case RoleEvidence::kNone:
      return "none";
    case RoleEvidence::kNames:
      return "names";
    case RoleEvidence::kTopology:
      return "topology";
    case RoleEvidence::kShape:
      return "shape";
    case RoleEvidence::kOverride:
      return "override";
  }
  return "unknown";
}

bool JointMap::HasLeg(int side) const {
  const LegRoles& leg = kLegRoles[side];
  return Has(leg.thigh) && Has(leg.shin) && Has(leg.foot);
}

bool JointMap::HasArm(int side) const {
  const ArmRoles& arm = kArmRoles[side];
  return Has(arm.upper_arm) && Has(arm.forearm) && Has(arm.hand);
}

double JointMap::Confidence() const {
  double least = 1;
  bool any = false;
  for (const RoleAssignment& role : roles) {
    if (role.joint < 0) continue;
    least = std::min(least, role.confidence);
    any = true;
  }
  return any ? least : 0;
}

std::vector<JointMapEntry> EntriesOf(const JointMap& map,
                                     const Skeleton& skeleton) {
  std::vector<JointMapEntry> entries;
  for (int i = 0; i < kBodyRoleCount; ++i) {
    const RoleAssignment& role = map.roles[i];
    if (role.joint < 0) continue;
    entries.push_back({std::string(BodyRoleName(static_cast<BodyRole>(i))),
                       skeleton.joint(role.joint).id, role.confidence,
                       std::string(RoleEvidenceName(role.evidence))});
  }
  return entries;
}

absl::StatusOr<JointMap> ProposeJointMap(
    const Skeleton& skeleton, absl::Span<const JointMapOverride> overrides,
    const ClipView* clip) {
  JointMap map;
  Given given = {};
  if (absl::Status status = ReadOverrides(skeleton, overrides, map, given);
      !status.ok()) {
    return status;
  }
  if (skeleton.joint_count() == 0) return map;
  return JointMapProposal(skeleton, std::move(map), given).Propose(clip);
}

std::vector<JointMapOverride> OverridesOfHumanoid(
    absl::Span<const std::pair<std::string, std::string>> joint_of_bone) {
  std::vector<JointMapOverride> overrides;
  for (int i = 0; i < kBodyRoleCount; ++i) {
    overrides.push_back(
        {std::string(BodyRoleName(static_cast<BodyRole>(i))), ""});
  }
  bool has_upper_chest = false;
  for (const auto& [bone, joint_id] : joint_of_bone) {
    const std::optional<BodyRole> role = RoleOfHumanoidBone(bone);
    if (!role) continue;
    const bool is_upper = absl::EqualsIgnoreCase(bone, "upperChest");
    if (*role == BodyRole::kChest && has_upper_chest && !is_upper) continue;
    has_upper_chest |= is_upper;
    overrides[IndexOf(*role)].joint_id = joint_id;
  }
  return overrides;
}

}  // namespace gelenk
