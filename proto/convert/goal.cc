#include "convert/goal.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "convert/geometry.h"
#include "gelenk/base/violations.h"

namespace gelenk::convert {
namespace {

AxisMask MaskFromProto(bool has_mask, const v1::AxisMask& proto) {
  if (!has_mask) return {};
  return {proto.x(), proto.y(), proto.z()};
}

void MaskToProto(const AxisMask& mask, v1::AxisMask* proto) {
  proto->set_x(mask.x);
  proto->set_y(mask.y);
  proto->set_z(mask.z);
}

bool IsWhole(const AxisMask& mask) { return mask.x && mask.y && mask.z; }

PositionGoal FromProto(const v1::PositionGoal& proto) {
  return {proto.end_effector_id(), convert::FromProto(proto.world_position()),
          MaskFromProto(proto.has_axes(), proto.axes())};
}

RotationGoal FromProto(const v1::RotationGoal& proto) {
  RotationGoal goal;
  goal.end_effector_id = proto.end_effector_id();
  if (proto.has_world_rotation()) {
    goal.world_rotation = convert::FromProto(proto.world_rotation());
  }
  return goal;
}

PoseGoal FromProto(const v1::PoseGoal& proto) {
  PoseGoal goal;
  goal.end_effector_id = proto.end_effector_id();
  goal.world_pose = convert::FromProto(proto.world_pose());
  if (proto.has_rotation_scale_m_per_rad()) {
    goal.rotation_scale_m_per_rad = proto.rotation_scale_m_per_rad();
  }
  goal.axes = MaskFromProto(proto.has_axes(), proto.axes());
  return goal;
}

void KindToProto(const PositionGoal& goal, v1::Goal* proto) {
  v1::PositionGoal* out = proto->mutable_position();
  out->set_end_effector_id(goal.end_effector_id);
  ToProto(goal.world_position, out->mutable_world_position());
  if (!IsWhole(goal.axes)) MaskToProto(goal.axes, out->mutable_axes());
}

void KindToProto(const RotationGoal& goal, v1::Goal* proto) {
  v1::RotationGoal* out = proto->mutable_rotation();
  out->set_end_effector_id(goal.end_effector_id);
  ToProto(goal.world_rotation, out->mutable_world_rotation());
}

void KindToProto(const PoseGoal& goal, v1::Goal* proto) {
  v1::PoseGoal* out = proto->mutable_pose();
  out->set_end_effector_id(goal.end_effector_id);
  ToProto(goal.world_pose, out->mutable_world_pose());
  out->set_rotation_scale_m_per_rad(goal.rotation_scale_m_per_rad);
  if (!IsWhole(goal.axes)) MaskToProto(goal.axes, out->mutable_axes());
}

// The kinds whose conversion is still to be written.
template <class Kind>
void KindToProto(const Kind&, v1::Goal*) {}

absl::Status NoKind(const v1::Goal& proto) {
  Violations violations;
  violations.Add("kind",
                 absl::StrCat("goal \"", absl::CHexEscape(proto.goal_id()),
                              "\" wishes nothing"));
  return violations.ToStatus();
}

std::vector<Goal>::iterator FindGoal(std::vector<Goal>& goals,
                                     const std::string& id) {
  return std::find_if(goals.begin(), goals.end(),
                      [&id](const Goal& goal) { return goal.id == id; });
}

}  // namespace

absl::StatusOr<Goal> FromProto(const v1::Goal& proto) {
  Goal goal;
  goal.id = proto.goal_id();
  if (proto.has_weight()) goal.weight = proto.weight();
  switch (proto.kind_case()) {
    case v1::Goal::kPosition:
      goal.kind = FromProto(proto.position());
      return goal;
    case v1::Goal::kRotation:
      goal.kind = FromProto(proto.rotation());
      return goal;
    case v1::Goal::kPose:
      goal.kind = FromProto(proto.pose());
      return goal;
    default:
      break;
  }
  return NoKind(proto);
}

absl::StatusOr<std::vector<Goal>> FromProto(
    const google::protobuf::RepeatedPtrField<v1::Goal>& protos) {
  Violations violations;
  std::vector<Goal> goals;
  goals.reserve(protos.size());
  for (int i = 0; i < protos.size(); ++i) {
    absl::StatusOr<Goal> goal = FromProto(protos[i]);
    violations.AddStatus(absl::StrCat("goals[", i, "]"), goal.status());
    if (goal.ok()) goals.push_back(*std::move(goal));
  }
  if (!violations.empty()) return violations.ToStatus();
  return goals;
}

void ToProto(const Goal& goal, v1::Goal* proto) {
  proto->set_goal_id(goal.id);
  proto->set_weight(goal.weight);
  std::visit([proto](const auto& kind) { KindToProto(kind, proto); },
             goal.kind);
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
    default:
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
