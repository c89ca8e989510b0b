#include "gelenk/ik/goals/pose_goal.h"

#include "gelenk/ik/goals/goal_check.h"

namespace gelenk {

void CheckAndNormalize(PoseGoal& goal, Violations& violations) {
  CheckPoint("world_pose.translation", goal.world_pose.translation, violations);
  CheckRotation("world_pose.rotation", goal.world_pose.rotation, violations);
  CheckNotNegative("rotation_scale_m_per_rad", goal.rotation_scale_m_per_rad,
                   violations);
}

void CheckOn(const Skeleton& skeleton, PoseGoal& goal, Violations& violations) {
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
}

}  // namespace gelenk
