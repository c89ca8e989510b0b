#include "gelenk/ik/goals/position_goal.h"

#include "gelenk/ik/goals/goal_check.h"

namespace gelenk {

void CheckAndNormalize(PositionGoal& goal, Violations& violations) {
  CheckPoint("world_position", goal.world_position, violations);
}

void CheckOn(const Skeleton& skeleton, PositionGoal& goal,
             Violations& violations) {
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
}

}  // namespace gelenk
