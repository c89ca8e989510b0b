// Reach a point. World frame, m.
#ifndef GELENK_IK_GOALS_POSITION_GOAL_H_
#define GELENK_IK_GOALS_POSITION_GOAL_H_

#include <Eigen/Core>
#include <string>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/effector_task.h"
#include "gelenk/ik/goals/axis_mask.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct PositionGoal {
  // An end effector, or a joint: its origin.
  std::string end_effector_id;
  Eigen::Vector3d world_position = Eigen::Vector3d::Zero();
  AxisMask axes;
};

inline absl::string_view KindName(const PositionGoal&) { return "position"; }
inline absl::string_view EffectorId(const PositionGoal& goal) {
  return goal.end_effector_id;
}
inline const Eigen::Vector3d& TargetOf(const PositionGoal& goal) {
  return goal.world_position;
}
inline void Retarget(PositionGoal& goal, const Eigen::Vector3d& target) {
  goal.world_position = target;
}

void CheckAndNormalize(PositionGoal& goal, Violations& violations);
void CheckOn(const Skeleton& skeleton, PositionGoal& goal,
             Violations& violations);

// What it looks at; `goal` has passed CheckOn.
EffectorTask TaskOf(const Skeleton& skeleton, const PositionGoal& goal);
// The part that moves, and the part that does not.
void StoreTarget(const PositionGoal& goal, kernel::TaskTarget& target);
void StoreRows(const PositionGoal& goal, double weight,
               kernel::TaskTarget& target);

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_POSITION_GOAL_H_
