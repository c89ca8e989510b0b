// What inverse kinematics is asked for: one wish each, with a weight and a
// priority.
//
// World frame, m, rad, unit quaternions. The goals of one priority share one
// weighted least-squares objective: sum over goals of weight * |residual|^2. A
// goal of a lower level never disturbs one of a higher level.
//
// A kind is a struct in goals/, in a file of its own, with the same functions
// beside it: KindName, EffectorId, TargetOf, Retarget, CheckAndNormalize (what
// needs no skeleton) and CheckOn (what needs one).
#ifndef GELENK_IK_GOAL_H_
#define GELENK_IK_GOAL_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <variant>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "gelenk/ik/goals/aim_goal.h"
#include "gelenk/ik/goals/center_of_mass_goal.h"
#include "gelenk/ik/goals/half_space_goal.h"
#include "gelenk/ik/goals/plant_goal.h"
#include "gelenk/ik/goals/pole_goal.h"
#include "gelenk/ik/goals/pose_goal.h"
#include "gelenk/ik/goals/position_goal.h"
#include "gelenk/ik/goals/posture_goal.h"
#include "gelenk/ik/goals/relative_goal.h"
#include "gelenk/ik/goals/rotation_goal.h"
#include "gelenk/math/rigid_transform.h"

namespace gelenk {

using GoalKind = std::variant<PositionGoal, RotationGoal, PoseGoal, AimGoal,
                              PoleGoal, RelativeGoal, CenterOfMassGoal,
                              PostureGoal, HalfSpaceGoal, PlantGoal>;

// Each level costs a factorisation; bodies use two or three.
inline constexpr int kMaxPriorities = 8;

struct Goal {
  // Unique in its problem.
  std::string id;
  // 0 switches the goal off and keeps it.
  double weight = 1;
  GoalKind kind;
  // 0 is the most important level, kMaxPriorities - 1 the least.
  int priority = 0;
};

// A new target for a goal, as its kind has it: a point, an orientation, a pose,
// a plane, the numbers of a posture, or nothing.
using GoalTarget =
    std::variant<Eigen::Vector3d, Eigen::Quaterniond, RigidTransform, Plane,
                 Eigen::VectorXd, std::monostate>;

// What the goal is mainly about: the end effector, or joint, of its residual;
// of a pole the tip; empty for the whole body.
absl::string_view EffectorId(const GoalKind& kind);
absl::string_view GoalKindName(const GoalKind& kind);
GoalTarget TargetOf(const GoalKind& kind);

// True when `target` is of the sort that `kind` takes. A plant takes none.
bool Fits(const GoalKind& kind, const GoalTarget& target);

// Replaces the target of `kind`; Fits is the caller's duty.
void Retarget(GoalKind& kind, const GoalTarget& target);

// INVALID_ARGUMENT naming the target's bad field and value. Normalises
// directions, and quaternions that are near unit. What a posture must be on its
// skeleton is left to CheckOn.
absl::Status CheckAndNormalize(GoalTarget& target);

// Checks everything about `goal` that needs no skeleton, and normalises it.
absl::Status CheckAndNormalize(Goal& goal);

// Checks what is left, once CheckAndNormalize has passed: ids, the order of a
// limb's joints, the size of a posture, whose quaternions it normalises.
absl::Status CheckOn(const Skeleton& skeleton, Goal& goal);

}  // namespace gelenk

#endif  // GELENK_IK_GOAL_H_
