// Put the centre of mass somewhere: by Joint.link_mass_kg and
// link_center_of_mass, or with equal masses where no joint has any. World
// frame, m.
#ifndef GELENK_IK_GOALS_CENTER_OF_MASS_GOAL_H_
#define GELENK_IK_GOALS_CENTER_OF_MASS_GOAL_H_

#include <Eigen/Core>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/effector_task.h"
#include "gelenk/ik/goals/axis_mask.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct CenterOfMassGoal {
  Eigen::Vector3d world_position = Eigen::Vector3d::Zero();
  AxisMask axes;
};

inline absl::string_view KindName(const CenterOfMassGoal&) {
  return "center_of_mass";
}
inline absl::string_view EffectorId(const CenterOfMassGoal&) { return {}; }
inline const Eigen::Vector3d& TargetOf(const CenterOfMassGoal& goal) {
  return goal.world_position;
}
inline void Retarget(CenterOfMassGoal& goal, const Eigen::Vector3d& target) {
  goal.world_position = target;
}

void CheckAndNormalize(CenterOfMassGoal& goal, Violations& violations);
inline void CheckOn(const Skeleton&, CenterOfMassGoal&, Violations&) {}

// It looks at no frame but at all links.
EffectorTask TaskOf(const Skeleton& skeleton, const CenterOfMassGoal& goal);
// The part that moves, and the part that does not.
void StoreTarget(const CenterOfMassGoal& goal, kernel::TaskTarget& target);
void StoreRows(const CenterOfMassGoal& goal, double weight,
               kernel::TaskTarget& target);

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_CENTER_OF_MASS_GOAL_H_
