// What inverse kinematics is asked for: one wish each, with a weight.
//
// World frame, m, unit quaternions. The goals of a problem share one weighted
// least-squares objective: sum over goals of weight * |residual|^2.
#ifndef GELENK_IK_GOAL_H_
#define GELENK_IK_GOAL_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <variant>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "gelenk/math/rigid_transform.h"

namespace gelenk {

// Which translation axes count, world frame.
struct AxisMask {
  bool x = true;
  bool y = true;
  bool z = true;
};

// Reach a point.
struct PositionGoal {
  // An end effector, or a joint: its origin.
  std::string end_effector_id;
  Eigen::Vector3d world_position = Eigen::Vector3d::Zero();
  AxisMask axes;
};

// Take an orientation.
struct RotationGoal {
  std::string end_effector_id;
  // world_from_end_effector.
  Eigen::Quaterniond world_rotation = Eigen::Quaterniond::Identity();
};

// Take a pose.
struct PoseGoal {
  std::string end_effector_id;
  // world_from_end_effector.
  RigidTransform world_pose;
  // What one radian counts against one metre; 0 leaves the rotation free.
  double rotation_scale_m_per_rad = 1;
  AxisMask axes;
};

using GoalKind = std::variant<PositionGoal, RotationGoal, PoseGoal>;

struct Goal {
  // Unique in its problem.
  std::string id;
  // 0 switches the goal off and keeps it.
  double weight = 1;
  GoalKind kind;
};

// A new target for a goal: a point, an orientation or a pose, as its kind has
// it.
using GoalTarget =
    std::variant<Eigen::Vector3d, Eigen::Quaterniond, RigidTransform>;

absl::string_view EffectorId(const GoalKind& kind);
absl::string_view GoalKindName(const GoalKind& kind);
GoalTarget TargetOf(const GoalKind& kind);

// True when `target` is of the sort that `kind` takes.
bool Fits(const GoalKind& kind, const GoalTarget& target);

// Replaces the target of `kind`; Fits is the caller's duty.
void Retarget(GoalKind& kind, const GoalTarget& target);

// INVALID_ARGUMENT naming the target's bad field and value. Normalises
// quaternions that are near unit.
absl::Status CheckAndNormalize(GoalTarget& target);

// Checks everything about `goal` that needs no skeleton, and normalises it.
absl::Status CheckAndNormalize(Goal& goal);

}  // namespace gelenk

#endif  // GELENK_IK_GOAL_H_
