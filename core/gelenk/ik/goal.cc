#include "gelenk/ik/goal.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

void CheckPoint(absl::string_view field, const Eigen::Vector3d& point,
                Violations& violations) {
  if (point.allFinite()) return;
  violations.Add(field, absl::StrFormat("want finite numbers, got (%g, %g, %g)",
                                        point.x(), point.y(), point.z()));
}

void CheckRotation(absl::string_view field, Eigen::Quaterniond& rotation,
                   Violations& violations) {
  if (NormalizeNearUnit(rotation.coeffs().data())) return;
  violations.Add(
      field,
      absl::StrFormat("want a unit quaternion, got (%g, %g, %g, %g)",
                      rotation.x(), rotation.y(), rotation.z(), rotation.w()));
}

void CheckScale(absl::string_view field, double value, Violations& violations) {
  if (std::isfinite(value) && value >= 0) return;
  violations.Add(field, absl::StrCat("want a finite number >= 0, got ", value));
}

}  // namespace

absl::string_view EffectorId(const GoalKind& kind) {
  return std::visit(
      [](const auto& k) -> absl::string_view { return k.end_effector_id; },
      kind);
}

absl::string_view GoalKindName(const GoalKind& kind) {
  return std::visit(Overloaded{[](const PositionGoal&) { return "position"; },
                               [](const RotationGoal&) { return "rotation"; },
                               [](const PoseGoal&) { return "pose"; }},
                    kind);
}

GoalTarget TargetOf(const GoalKind& kind) {
  return std::visit(
      Overloaded{
          [](const PositionGoal& k) { return GoalTarget(k.world_position); },
          [](const RotationGoal& k) { return GoalTarget(k.world_rotation); },
          [](const PoseGoal& k) { return GoalTarget(k.world_pose); }},
      kind);
}

bool Fits(const GoalKind& kind, const GoalTarget& target) {
  return std::visit(
      Overloaded{[&](const PositionGoal&) {
                   return std::holds_alternative<Eigen::Vector3d>(target);
                 },
                 [&](const RotationGoal&) {
                   return std::holds_alternative<Eigen::Quaterniond>(target);
                 },
                 [&](const PoseGoal&) {
                   return std::holds_alternative<RigidTransform>(target);
                 }},
      kind);
}

void Retarget(GoalKind& kind, const GoalTarget& target) {
  std::visit(Overloaded{[&](PositionGoal& k) {
                          k.world_position = std::get<Eigen::Vector3d>(target);
                        },
                        [&](RotationGoal& k) {
                          k.world_rotation =
                              std::get<Eigen::Quaterniond>(target);
                        },
                        [&](PoseGoal& k) {
                          k.world_pose = std::get<RigidTransform>(target);
                        }},
             kind);
}

absl::Status CheckAndNormalize(GoalTarget& target) {
  Violations violations;
  std::visit(Overloaded{[&](const Eigen::Vector3d& point) {
                          CheckPoint("world_position", point, violations);
                        },
                        [&](Eigen::Quaterniond& rotation) {
                          CheckRotation("world_rotation", rotation, violations);
                        },
                        [&](RigidTransform& pose) {
                          CheckPoint("world_pose.translation", pose.translation,
                                     violations);
                          CheckRotation("world_pose.rotation", pose.rotation,
                                        violations);
                        }},
             target);
  return violations.ToStatus();
}

absl::Status CheckAndNormalize(Goal& goal) {
  Violations violations;
  CheckId("goal_id", goal.id, violations);
  CheckScale("weight", goal.weight, violations);
  GoalTarget target = TargetOf(goal.kind);
  violations.AddStatus(GoalKindName(goal.kind), CheckAndNormalize(target));
  Retarget(goal.kind, target);
  if (const PoseGoal* pose = std::get_if<PoseGoal>(&goal.kind)) {
    CheckScale("pose.rotation_scale_m_per_rad", pose->rotation_scale_m_per_rad,
               violations);
  }
  return violations.ToStatus();
}

}  // namespace gelenk
