#include "gelenk/ik/goals/plant_goal.h"

#include "gelenk/ik/goals/goal_check.h"
#include "gelenk/ik/goals/pose_rows.h"

namespace gelenk {

void CheckAndNormalize(PlantGoal& goal, Violations& violations) {
  CheckNotNegative("rotation_scale_m_per_rad", goal.rotation_scale_m_per_rad,
                   violations);
}

void CheckOn(const Skeleton& skeleton, PlantGoal& goal,
             Violations& violations) {
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
}

EffectorTask TaskOf(const Skeleton& skeleton, const PlantGoal& goal) {
  return PoseTask(skeleton, goal.end_effector_id, true, {});
}

void StoreTarget(const PlantGoal&, kernel::TaskTarget&) {}

void StoreRows(const PlantGoal& goal, double weight,
               kernel::TaskTarget& target) {
  StorePoseRows(true, {}, {}, goal.rotation_scale_m_per_rad, weight, target);
}

}  // namespace gelenk
