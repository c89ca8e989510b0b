#include "gelenk/ik/goals/plant_goal.h"

#include "gelenk/ik/goals/goal_check.h"

namespace gelenk {

void CheckAndNormalize(PlantGoal& goal, Violations& violations) {
  CheckNotNegative("rotation_scale_m_per_rad", goal.rotation_scale_m_per_rad,
                   violations);
}

void CheckOn(const Skeleton& skeleton, PlantGoal& goal,
             Violations& violations) {
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
}

}  // namespace gelenk
