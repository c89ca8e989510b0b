#include "gelenk/ik/goals/center_of_mass_goal.h"

#include "gelenk/ik/goals/frame_rows.h"
#include "gelenk/ik/goals/goal_check.h"
#include "gelenk/ik/goals/pose_rows.h"

namespace gelenk {

void CheckAndNormalize(CenterOfMassGoal& goal, Violations& violations) {
  CheckNumbers("world_position", goal.world_position, violations);
}

EffectorTask TaskOf(const Skeleton&, const CenterOfMassGoal&) {
  EffectorTask task;
  task.shape = kernel::GoalShape::kCenterOfMass;
  task.translation_rows = 3;
  return task;
}

void StoreTarget(const CenterOfMassGoal& goal, kernel::TaskTarget& target) {
  Store(goal.world_position, target.world_translation);
}

void StoreRows(const CenterOfMassGoal& goal, double weight,
               kernel::TaskTarget& target) {
  StorePoseRows(true, goal.axes, kNoAxes, 0, weight, target);
  target.shape = kernel::GoalShape::kCenterOfMass;
  target.rotation_rows = 0;
}

}  // namespace gelenk
