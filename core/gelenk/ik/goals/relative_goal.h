// Hold one end effector in the frame of another: two hands on one stick. m,
// unit quaternion.
#ifndef GELENK_IK_GOALS_RELATIVE_GOAL_H_
#define GELENK_IK_GOALS_RELATIVE_GOAL_H_

#include <string>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/effector_task.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct RelativeGoal {
  // The frame's owner.
  std::string reference_end_effector_id;
  // The one that is held.
  std::string end_effector_id;
  RigidTransform reference_from_end_effector;
  // What one radian counts against one metre; 0 leaves the rotation free.
  double rotation_scale_m_per_rad = 1;
};

inline absl::string_view KindName(const RelativeGoal&) { return "relative"; }
inline absl::string_view EffectorId(const RelativeGoal& goal) {
  return goal.end_effector_id;
}
inline const RigidTransform& TargetOf(const RelativeGoal& goal) {
  return goal.reference_from_end_effector;
}
inline void Retarget(RelativeGoal& goal, const RigidTransform& target) {
  goal.reference_from_end_effector = target;
}

void CheckAndNormalize(RelativeGoal& goal, Violations& violations);
void CheckOn(const Skeleton& skeleton, RelativeGoal& goal,
             Violations& violations);

// What it looks at; `goal` has passed CheckOn.
EffectorTask TaskOf(const Skeleton& skeleton, const RelativeGoal& goal);
// The part that moves, and the part that does not.
void StoreTarget(const RelativeGoal& goal, kernel::TaskTarget& target);
void StoreRows(const RelativeGoal& goal, double weight,
               kernel::TaskTarget& target);

void LinearizeRelative(const kernel::TaskTarget& target,
                       const kernel::GoalFrame* frames, kernel::GoalRows& rows);

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_RELATIVE_GOAL_H_
