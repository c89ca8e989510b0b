#include "convert/goal.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "convert/geometry.h"
#include "convert/goal_kind.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/goal_list_check.h"

namespace gelenk::convert {
namespace {

// What stands beside the kind.
Goal GoalWithoutKind(const v1::Goal& proto) {
  Goal goal;
  goal.id = proto.goal_id();
  if (proto.has_weight()) goal.weight = proto.weight();
  goal.priority = proto.priority();
  return goal;
}

// What is wrong with a list that holds goals without a kind, all of it: no
// problem can be made of them that would tell the rest.
absl::Status FaultsOf(
    const google::protobuf::RepeatedPtrField<v1::Goal>& protos,
    const Skeleton* skeleton) {
  Violations violations;
  GoalListCheck check(skeleton, violations);
  check.AddCount(protos.size());
  for (const v1::Goal& proto : protos) {
    Goal goal = GoalWithoutKind(proto);
    std::optional<GoalKind> kind = KindFromProto(proto);
    if (!kind) {
      check.AddWithoutKind(goal);
      continue;
    }
    goal.kind = *std::move(kind);
    check.Add(goal);
  }
  return violations.ToStatus();
}

std::vector<Goal>::iterator FindGoal(std::vector<Goal>& goals,
                                     const std::string& id) {
  return std::find_if(goals.begin(), goals.end(),
                      [&id](const Goal& goal) { return goal.id == id; });
}

}  // namespace

absl::StatusOr<Goal> FromProto(const v1::Goal& proto) {
  Goal goal = GoalWithoutKind(proto);
  std::optional<GoalKind> kind = KindFromProto(proto);
  if (!kind) return CheckWithoutKind(goal);
  goal.kind = *std::move(kind);
  return goal;
}

absl::StatusOr<std::vector<Goal>> FromProto(
    const google::protobuf::RepeatedPtrField<v1::Goal>& protos,
    const Skeleton* skeleton) {
  std::vector<Goal> goals;
  goals.reserve(protos.size());
  for (const v1::Goal& proto : protos) {
    absl::StatusOr<Goal> goal = FromProto(proto);
    if (!goal.ok()) return FaultsOf(protos, skeleton);
    goals.push_back(*std::move(goal));
  }
  return goals;
}

void ToProto(const Goal& goal, v1::Goal* proto) {
  proto->set_goal_id(goal.id);
  proto->set_weight(goal.weight);
  proto->set_priority(goal.priority);
  KindToProto(goal.kind, proto);
}

void ToProto(absl::Span<const Goal> goals,
             google::protobuf::RepeatedPtrField<v1::Goal>* protos) {
  protos->Clear();
  for (const Goal& goal : goals) ToProto(goal, protos->Add());
}

absl::Status FromProto(const v1::GoalTarget& proto, GoalTarget* target) {
  switch (proto.target_case()) {
    case v1::GoalTarget::kWorldPosition:
      *target = FromProto(proto.world_position());
      return absl::OkStatus();
    case v1::GoalTarget::kWorldRotation:
      *target = FromProto(proto.world_rotation());
      return absl::OkStatus();
    case v1::GoalTarget::kWorldPose:
      *target = FromProto(proto.world_pose());
      return absl::OkStatus();
    case v1::GoalTarget::kReferenceFromEndEffector:
      *target = FromProto(proto.reference_from_end_effector());
      return absl::OkStatus();
    case v1::GoalTarget::kPosture: {
      const auto& positions = proto.posture().positions();
      *target = Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
          positions.data(), positions.size()));
      return absl::OkStatus();
    }
    case v1::GoalTarget::kPlane:
      *target =
          Plane{FromProto(proto.plane().normal()), proto.plane().offset_m()};
      return absl::OkStatus();
    case v1::GoalTarget::TARGET_NOT_SET:
      break;
  }
  Violations violations;
  violations.Add("target", "is not set");
  return violations.ToStatus();
}

absl::StatusOr<std::vector<Goal>> Merge(absl::Span<const Goal> goals,
                                        const v1::GoalPatch& patch) {
  Violations violations;
  std::vector<Goal> merged(goals.begin(), goals.end());
  for (int i = 0; i < patch.removed_goal_ids_size(); ++i) {
    const auto found = FindGoal(merged, patch.removed_goal_ids(i));
    if (found != merged.end()) {
      merged.erase(found);
      continue;
    }
    violations.Add(
        absl::StrCat("goal_patch.removed_goal_ids[", i, "]"),
        absl::StrCat("no goal \"", absl::CHexEscape(patch.removed_goal_ids(i)),
                     "\""));
  }
  for (int i = 0; i < patch.goals_size(); ++i) {
    const v1::Goal& proto = patch.goals(i);
    const auto found = FindGoal(merged, proto.goal_id());
    const bool keeps_kind =
        found != merged.end() && proto.kind_case() == v1::Goal::KIND_NOT_SET;
    if (keeps_kind) {
      if (proto.has_weight()) found->weight = proto.weight();
      if (proto.priority() != 0) found->priority = proto.priority();
      continue;
    }
    absl::StatusOr<Goal> goal = FromProto(proto);
    violations.AddStatus(absl::StrCat("goal_patch.goals[", i, "]"),
                         goal.status());
    if (!goal.ok()) continue;
    if (found == merged.end()) {
      merged.push_back(*std::move(goal));
    } else {
      if (!proto.has_weight()) goal->weight = found->weight;
      *found = *std::move(goal);
    }
  }
  if (!violations.empty()) return violations.ToStatus();
  return merged;
}

}  // namespace gelenk::convert
