#include "gelenk/ik/goals/half_space_goal.h"

#include "gelenk/ik/goals/frame_rows.h"
#include "gelenk/ik/goals/goal_check.h"
#include "gelenk/ik/goals/pose_rows.h"

namespace gelenk {

void CheckAndNormalize(Plane& plane, Violations& violations) {
  CheckDirection("world_normal", plane.world_normal, violations);
  CheckNumber("offset_m", plane.offset_m, violations);
}

void CheckAndNormalize(HalfSpaceGoal& goal, Violations& violations) {
  Plane plane = TargetOf(goal);
  CheckAndNormalize(plane, violations);
  goal.world_normal = plane.world_normal;
}

void CheckOn(const Skeleton& skeleton, HalfSpaceGoal& goal,
             Violations& violations) {
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
  if (!goal.is_ground) return;
  goal.world_normal = skeleton.up();
  goal.offset_m = 0;
}

EffectorTask TaskOf(const Skeleton& skeleton, const HalfSpaceGoal& goal) {
  return TaskOnEffector(skeleton, goal.end_effector_id,
                        kernel::GoalShape::kHalfSpace, 1, 0);
}

void StoreTarget(const HalfSpaceGoal& goal, kernel::TaskTarget& target) {
  Store(goal.world_normal, target.direction);
  target.offset = goal.offset_m;
}

void StoreRows(const HalfSpaceGoal&, double weight,
               kernel::TaskTarget& target) {
  StoreScales(kernel::GoalShape::kHalfSpace, 1, 0, 0, weight, target);
}

void LinearizeHalfSpace(const kernel::TaskTarget& target,
                        const kernel::GoalFrame* frames,
                        kernel::GoalRows& rows) {
  const Eigen::Vector3d normal = View(target.direction);
  const double depth = target.offset - normal.dot(View(frames[0].translation));
  const bool behind = depth > 0;
  rows.clearance = -depth;
  rows.residual[0] = behind ? depth : 0;
  rows.position_error2 = rows.residual[0] * rows.residual[0];
  rows.rotation_error2 = 0;
  rows.rotation_energy = 0;
  VelocityRow(rows, 0, 0) = behind ? normal : Eigen::Vector3d::Zero();
  AngularRow(rows, 0, 0).setZero();
}

}  // namespace gelenk
