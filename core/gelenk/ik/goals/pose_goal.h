// Take a pose. World frame, m, unit quaternion.
#ifndef GELENK_IK_GOALS_POSE_GOAL_H_
#define GELENK_IK_GOALS_POSE_GOAL_H_

#include <string>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/effector_task.h"
#include "gelenk/ik/goals/axis_mask.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct PoseGoal {
  std::string end_effector_id;
  // world_from_end_effector.
  RigidTransform world_pose;
  // What one radian counts against one metre; 0 leaves the rotation free.
  double rotation_scale_m_per_rad = 1;
  // Of the translation.
  AxisMask axes;
  // World axes: the rotation left over about any other one is free.
  AxisMask rotation_axes;
};

inline absl::string_view KindName(const PoseGoal&) { return "pose"; }
inline absl::string_view EffectorId(const PoseGoal& goal) {
  return goal.end_effector_id;
}
inline const RigidTransform& TargetOf(const PoseGoal& goal) {
  return goal.world_pose;
}
inline void Retarget(PoseGoal& goal, const RigidTransform& target) {
  goal.world_pose = target;
}

void CheckAndNormalize(PoseGoal& goal, Violations& violations);
void CheckOn(const Skeleton& skeleton, PoseGoal& goal, Violations& violations);

// What it looks at; `goal` has passed CheckOn.
EffectorTask TaskOf(const Skeleton& skeleton, const PoseGoal& goal);
// The part that moves, and the part that does not.
void StoreTarget(const PoseGoal& goal, kernel::TaskTarget& target);
void StoreRows(const PoseGoal& goal, double weight, kernel::TaskTarget& target);

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_POSE_GOAL_H_
