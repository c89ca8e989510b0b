#include "gelenk/ik/goals/pose_goal.h"

#include "gelenk/ik/goals/frame_rows.h"
#include "gelenk/ik/goals/goal_check.h"
#include "gelenk/ik/goals/pose_rows.h"

namespace gelenk {

void CheckAndNormalize(PoseGoal& goal, Violations& violations) {
  CheckNumbers("world_pose.translation", goal.world_pose.translation,
               violations);
  CheckRotation("world_pose.rotation", goal.world_pose.rotation, violations);
  CheckNotNegative("rotation_scale_m_per_rad", goal.rotation_scale_m_per_rad,
                   violations);
}

void CheckOn(const Skeleton& skeleton, PoseGoal& goal, Violations& violations) {
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
}

EffectorTask TaskOf(const Skeleton& skeleton, const PoseGoal& goal) {
  return PoseTask(skeleton, goal.end_effector_id, true, goal.rotation_axes);
}

void StoreTarget(const PoseGoal& goal, kernel::TaskTarget& target) {
  Store(goal.world_pose.translation, target.world_translation);
  StoreRotation(goal.world_pose.rotation, target);
}

void StoreRows(const PoseGoal& goal, double weight,
               kernel::TaskTarget& target) {
  StorePoseRows(true, goal.axes, goal.rotation_axes,
                goal.rotation_scale_m_per_rad, weight, target);
}

}  // namespace gelenk
