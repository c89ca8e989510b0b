#include "gelenk/ik/goals/center_of_mass_goal.h"

#include "gelenk/ik/goals/goal_check.h"

namespace gelenk {

void CheckAndNormalize(CenterOfMassGoal& goal, Violations& violations) {
  CheckPoint("world_position", goal.world_position, violations);
}

}  // namespace gelenk
