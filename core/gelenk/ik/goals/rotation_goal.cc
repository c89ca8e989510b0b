#include "gelenk/ik/goals/rotation_goal.h"

#include "gelenk/ik/goals/goal_check.h"
#include "gelenk/ik/goals/pose_rows.h"

namespace gelenk {

void CheckAndNormalize(RotationGoal& goal, Violations& violations) {
  CheckRotation("world_rotation", goal.world_rotation, violations);
}

void CheckOn(const Skeleton& skeleton, RotationGoal& goal,
             Violations& violations) {
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
}

EffectorTask TaskOf(const Skeleton& skeleton, const RotationGoal& goal) {
  return PoseTask(skeleton, goal.end_effector_id, false, goal.axes);
}

void StoreTarget(const RotationGoal& goal, kernel::TaskTarget& target) {
  StoreRotation(goal.world_rotation, target);
}

void StoreRows(const RotationGoal& goal, double weight,
               kernel::TaskTarget& target) {
  StorePoseRows(false, kNoAxes, goal.axes, 1, weight, target);
}

}  // namespace gelenk
