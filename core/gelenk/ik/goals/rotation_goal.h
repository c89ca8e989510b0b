// Take an orientation. World frame, unit quaternion, rad.
#ifndef GELENK_IK_GOALS_ROTATION_GOAL_H_
#define GELENK_IK_GOALS_ROTATION_GOAL_H_

#include <Eigen/Geometry>
#include <string>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/effector_task.h"
#include "gelenk/ik/goals/axis_mask.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct RotationGoal {
  std::string end_effector_id;
  // world_from_end_effector.
  Eigen::Quaterniond world_rotation = Eigen::Quaterniond::Identity();
  // World axes: the rotation left over about any other one is free.
  AxisMask axes;
};

inline absl::string_view KindName(const RotationGoal&) { return "rotation"; }
inline absl::string_view EffectorId(const RotationGoal& goal) {
  return goal.end_effector_id;
}
inline const Eigen::Quaterniond& TargetOf(const RotationGoal& goal) {
  return goal.world_rotation;
}
inline void Retarget(RotationGoal& goal, const Eigen::Quaterniond& target) {
  goal.world_rotation = target;
}

void CheckAndNormalize(RotationGoal& goal, Violations& violations);
void CheckOn(const Skeleton& skeleton, RotationGoal& goal,
             Violations& violations);

// What it looks at; `goal` has passed CheckOn.
EffectorTask TaskOf(const Skeleton& skeleton, const RotationGoal& goal);
// The part that moves, and the part that does not.
void StoreTarget(const RotationGoal& goal, kernel::TaskTarget& target);
void StoreRows(const RotationGoal& goal, double weight,
               kernel::TaskTarget& target);

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_ROTATION_GOAL_H_
