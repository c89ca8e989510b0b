#include "gelenk/ik/goals/aim_goal.h"

#include "gelenk/ik/goals/goal_check.h"

namespace gelenk {

void CheckAndNormalize(AimGoal& goal, Violations& violations) {
  CheckDirection("axis", goal.axis, violations);
  CheckPoint("world_point", goal.world_point, violations);
}

void CheckOn(const Skeleton& skeleton, AimGoal& goal, Violations& violations) {
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
}

}  // namespace gelenk
