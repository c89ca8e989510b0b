#include "convert/joint_map.h"

#include <array>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/retarget/body_role.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk::convert {
namespace {

// The contract counts roles from 1: 0 is none.
static_assert(v1::BODY_ROLE_PELVIS == IndexOf(BodyRole::kPelvis) + 1);
static_assert(v1::BODY_ROLE_RIGHT_TOE == IndexOf(BodyRole::kRightToe) + 1);
static_assert(v1::BODY_ROLE_RIGHT_TOE == kBodyRoleCount);

v1::RoleEvidence ToProto(RoleEvidence evidence) {
  switch (evidence) {
    case RoleEvidence::kNone:
      break;
    case RoleEvidence::kNames:
      return v1::ROLE_EVIDENCE_NAMES;
    case RoleEvidence::kTopology:
      return v1::ROLE_EVIDENCE_TOPOLOGY;
    case RoleEvidence::kShape:
      return v1::ROLE_EVIDENCE_SHAPE;
    case RoleEvidence::kOverride:
      return v1::ROLE_EVIDENCE_GIVEN;
  }
  return v1::ROLE_EVIDENCE_UNSPECIFIED;
}

// What a pair says of one side.
struct PairSide {
  absl::string_view field;
  bool is_given;
  const std::string& joint_id;
};

PairSide SideOf(const v1::JointPair& pair, MapSide side) {
  if (side == MapSide::kSource) {
    return {"source_joint_id", pair.has_source_joint_id(),
            pair.source_joint_id()};
  }
  return {"target_joint_id", pair.has_target_joint_id(),
          pair.target_joint_id()};
}

}  // namespace

absl::StatusOr<std::vector<JointMapOverride>> FromProto(
    const v1::JointMap& proto, MapSide side, const Skeleton& skeleton) {
  Violations violations;
  std::vector<JointMapOverride> overrides;
  std::array<bool, kBodyRoleCount> named = {};
  std::vector<bool> taken(skeleton.joint_count(), false);
  for (int i = 0; i < proto.pairs_size(); ++i) {
    const v1::JointPair& pair = proto.pairs(i);
    const int role = pair.role() - 1;
    const std::string path = absl::StrCat("pairs[", i, "].");
    if (role < 0 || role >= kBodyRoleCount) {
      violations.Add(absl::StrCat(path, "role"),
                     absl::StrCat("no such role: ", role + 1));
      continue;
    }
    const absl::string_view name = BodyRoleName(static_cast<BodyRole>(role));
    if (named[role]) {
      violations.Add(absl::StrCat(path, "role"),
                     absl::StrCat(name, " comes twice"));
      continue;
    }
    named[role] = true;
    const PairSide given = SideOf(pair, side);
    if (!given.is_given) continue;
    if (!given.joint_id.empty()) {
      const int joint = skeleton.FindJoint(given.joint_id);
      if (joint < 0 || taken[joint]) {
        violations.Add(absl::StrCat(path, given.field),
                       absl::StrCat(joint < 0 ? "no joint " : "two roles for ",
                                    QuotedId(given.joint_id)));
        continue;
      }
      taken[joint] = true;
    }
    overrides.push_back({std::string(name), given.joint_id});
  }
  if (!violations.empty()) return violations.ToStatus();
  return overrides;
}

v1::JointMap ToProto(absl::Span<const JointMapOverride> source,
                     absl::Span<const JointMapOverride> target) {
  v1::JointMap proto;
  std::array<v1::JointPair*, kBodyRoleCount> pairs = {};
  const auto pair_of = [&](const JointMapOverride& told) {
    const int role = IndexOf(*FindBodyRole(told.role));
    if (pairs[role] == nullptr) {
      pairs[role] = proto.add_pairs();
      pairs[role]->set_role(static_cast<v1::BodyRole>(role + 1));
    }
    return pairs[role];
  };
  for (const JointMapOverride& told : source) {
    pair_of(told)->set_source_joint_id(told.joint_id);
  }
  for (const JointMapOverride& told : target) {
    pair_of(told)->set_target_joint_id(told.joint_id);
  }
  return proto;
}

void ToProto(const MappedSkeleton& source, const MappedSkeleton& target,
             v1::JointMap* proto) {
  proto->Clear();
  for (int i = 0; i < kBodyRoleCount; ++i) {
    const RoleAssignment& from = source.map.roles[i];
    const RoleAssignment& to = target.map.roles[i];
    if (from.joint < 0 && to.joint < 0) continue;
    v1::JointPair* pair = proto->add_pairs();
    pair->set_role(static_cast<v1::BodyRole>(i + 1));
    if (from.joint >= 0) {
      pair->set_source_joint_id(source.skeleton.joint(from.joint).id);
      pair->set_source_confidence(from.confidence);
      pair->set_source_evidence(ToProto(from.evidence));
    }
    if (to.joint >= 0) {
      pair->set_target_joint_id(target.skeleton.joint(to.joint).id);
      pair->set_target_confidence(to.confidence);
      pair->set_target_evidence(ToProto(to.evidence));
    }
  }
  for (const std::string& note : source.map.notes) {
    proto->add_source_notes(note);
  }
  for (const std::string& note : target.map.notes) {
    proto->add_target_notes(note);
  }
}

}  // namespace gelenk::convert
