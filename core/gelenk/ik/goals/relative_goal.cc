#include "gelenk/ik/goals/relative_goal.h"

#include "gelenk/ik/goals/goal_check.h"

namespace gelenk {

void CheckAndNormalize(RelativeGoal& goal, Violations& violations) {
  RigidTransform& pose = goal.reference_from_end_effector;
  CheckPoint("reference_from_end_effector.translation", pose.translation,
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

}  // namespace gelenk
