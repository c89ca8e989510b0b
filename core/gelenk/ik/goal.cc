#include "gelenk/ik/goal.h"

#include <type_traits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/goal_list_check.h"
#include "gelenk/ik/goals/goal_check.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

template <class Kind>
using TargetType = std::decay_t<decltype(TargetOf(std::declval<Kind>()))>;

void CheckBesideKind(const Goal& goal, Violations& violations) {
  CheckId("goal_id", goal.id, violations);
  CheckNotNegative("weight", goal.weight, violations);
  if (goal.priority < 0 || goal.priority >= kMaxPriorities) {
    violations.Add("priority",
                   absl::StrFormat("want 0 to %d, got %d", kMaxPriorities - 1,
                                   goal.priority));
  }
}

}  // namespace

absl::string_view EffectorId(const GoalKind& kind) {
  return std::visit([](const auto& k) { return EffectorId(k); }, kind);
}

absl::string_view GoalKindName(const GoalKind& kind) {
  return std::visit([](const auto& k) { return KindName(k); }, kind);
}

GoalTarget TargetOf(const GoalKind& kind) {
  return std::visit([](const auto& k) { return GoalTarget(TargetOf(k)); },
                    kind);
}

bool Fits(const GoalKind& kind, const GoalTarget& target) {
  return std::visit(
      [&](const auto& k) {
        using Target = TargetType<decltype(k)>;
        return !std::is_same_v<Target, std::monostate> &&
               std::holds_alternative<Target>(target);
      },
      kind);
}

void Retarget(GoalKind& kind, const GoalTarget& target) {
  std::visit(
      [&](auto& k) { Retarget(k, std::get<TargetType<decltype(k)>>(target)); },
      kind);
}

absl::Status CheckAndNormalize(GoalTarget& target) {
  Violations violations;
  std::visit(Overloaded{[&](const Eigen::Vector3d& point) {
                          CheckNumbers("world_position", point, violations);
                        },
                        [&](Eigen::Quaterniond& rotation) {
                          CheckRotation("world_rotation", rotation, violations);
                        },
                        [&](RigidTransform& pose) {
                          CheckNumbers("world_pose.translation",
                                       pose.translation, violations);
                          CheckRotation("world_pose.rotation", pose.rotation,
                                        violations);
                        },
                        [&](Plane& plane) {
                          Violations of_plane;
                          CheckAndNormalize(plane, of_plane);
                          violations.AddStatus("plane", of_plane.ToStatus());
                        },
                        [](const Eigen::VectorXd&) {}, [](std::monostate) {}},
             target);
  return violations.ToStatus();
}

absl::Status CheckAndNormalize(Goal& goal) {
  Violations violations;
  CheckBesideKind(goal, violations);
  Violations of_kind;
  std::visit([&](auto& kind) { CheckAndNormalize(kind, of_kind); }, goal.kind);
  violations.AddStatus(GoalKindName(goal.kind), of_kind.ToStatus());
  return violations.ToStatus();
}

absl::Status CheckWithoutKind(const Goal& goal) {
  Violations violations;
  CheckBesideKind(goal, violations);
  violations.Add("kind",
                 absl::StrCat("goal ", QuotedId(goal.id), " wishes nothing"));
  return violations.ToStatus();
}

absl::Status CheckOn(const Skeleton& skeleton, Goal& goal) {
  Violations of_kind;
  std::visit([&](auto& kind) { CheckOn(skeleton, kind, of_kind); }, goal.kind);
  Violations violations;
  violations.AddStatus(GoalKindName(goal.kind), of_kind.ToStatus());
  return violations.ToStatus();
}

}  // namespace gelenk
