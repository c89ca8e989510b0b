#include "gelenk/ik/goals/rotation_goal.h"

#include "gelenk/ik/goals/goal_check.h"

namespace gelenk {

void CheckAndNormalize(RotationGoal& goal, Violations& violations) {
  CheckRotation("world_rotation", goal.world_rotation, violations);
}

void CheckOn(const Skeleton& skeleton, RotationGoal& goal,
             Violations& violations) {
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
}

}  // namespace gelenk
