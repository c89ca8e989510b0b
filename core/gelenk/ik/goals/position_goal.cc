#include "gelenk/ik/goals/position_goal.h"

#include "gelenk/ik/goals/frame_rows.h"
#include "gelenk/ik/goals/goal_check.h"
#include "gelenk/ik/goals/pose_rows.h"

namespace gelenk {

void CheckAndNormalize(PositionGoal& goal, Violations& violations) {
  CheckNumbers("world_position", goal.world_position, violations);
}

void CheckOn(const Skeleton& skeleton, PositionGoal& goal,
             Violations& violations) {
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
}

EffectorTask TaskOf(const Skeleton& skeleton, const PositionGoal& goal) {
  return PoseTask(skeleton, goal.end_effector_id, true, kNoAxes);
}

void StoreTarget(const PositionGoal& goal, kernel::TaskTarget& target) {
  Store(goal.world_position, target.world_translation);
}

void StoreRows(const PositionGoal& goal, double weight,
               kernel::TaskTarget& target) {
  StorePoseRows(true, goal.axes, kNoAxes, 0, weight, target);
}

}  // namespace gelenk
