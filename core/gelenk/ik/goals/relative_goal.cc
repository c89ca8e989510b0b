#include "gelenk/ik/goals/relative_goal.h"

#include "gelenk/ik/goals/frame_rows.h"
#include "gelenk/ik/goals/goal_check.h"
#include "gelenk/ik/goals/pose_rows.h"

namespace gelenk {

void CheckAndNormalize(RelativeGoal& goal, Violations& violations) {
  RigidTransform& pose = goal.reference_from_end_effector;
  CheckNumbers("reference_from_end_effector.translation", pose.translation,
               violations);
  CheckRotation("reference_from_end_effector.rotation", pose.rotation,
                violations);
  CheckNotNegative("rotation_scale_m_per_rad", goal.rotation_scale_m_per_rad,
                   violations);
}

void CheckOn(const Skeleton& skeleton, RelativeGoal& goal,
             Violations& violations) {
  CheckEffector(skeleton, "reference_end_effector_id",
                goal.reference_end_effector_id, violations);
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
}

EffectorTask TaskOf(const Skeleton& skeleton, const RelativeGoal& goal) {
  EffectorTask task = TaskOnEffector(skeleton, goal.reference_end_effector_id,
                                     kernel::GoalShape::kRelative, 3, 3);
  task.frames[task.frame_count++] =
      *skeleton.FindEffector(goal.end_effector_id);
  return task;
}

void StoreTarget(const RelativeGoal& goal, kernel::TaskTarget& target) {
  Store(goal.reference_from_end_effector.translation, target.world_translation);
  StoreRotation(goal.reference_from_end_effector.rotation, target);
}

void StoreRows(const RelativeGoal& goal, double weight,
               kernel::TaskTarget& target) {
  StoreScales(kernel::GoalShape::kRelative, 3, 3, goal.rotation_scale_m_per_rad,
              weight, target);
}

void LinearizeRelative(const kernel::TaskTarget& target,
                       const kernel::GoalFrame* frames,
                       kernel::GoalRows& rows) {
  const Eigen::Matrix3d world_from_reference = View(frames[0].rotation);
  const Eigen::Vector3d arm =
      world_from_reference * View(target.world_translation);
  // The rows of a pose whose target moves with the reference.
  kernel::TaskTarget pose = target;
  Store(View(frames[0].translation) + arm, pose.world_translation);
  Store(world_from_reference * View(target.world_rotation),
        pose.world_rotation);
  LinearizePose(pose, frames[1], rows);
  const Eigen::Matrix3d arm_cross = (Eigen::Matrix3d() << 0, -arm.z(), arm.y(),
                                     arm.z(), 0, -arm.x(), -arm.y(), arm.x(), 0)
                                        .finished();
  for (int r = 0; r < 6; ++r) {
    const Row3 velocity = VelocityRow(rows, 0, r);
    const Row3 angular = AngularRow(rows, 0, r);
    VelocityRow(rows, 1, r) = velocity;
    AngularRow(rows, 1, r) = angular;
    VelocityRow(rows, 0, r) = -velocity;
    AngularRow(rows, 0, r) = velocity * arm_cross - angular;
  }
}

}  // namespace gelenk
