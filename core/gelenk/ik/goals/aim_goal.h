// Point an axis of an end effector at a point: eyes, a camera, a lamp. World
// frame, m.
#ifndef GELENK_IK_GOALS_AIM_GOAL_H_
#define GELENK_IK_GOALS_AIM_GOAL_H_

#include <Eigen/Core>
#include <string>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/effector_task.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct AimGoal {
  std::string end_effector_id;
  // End effector frame; any length but zero, normalised.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d world_point = Eigen::Vector3d::Zero();
};

inline absl::string_view KindName(const AimGoal&) { return "aim"; }
inline absl::string_view EffectorId(const AimGoal& goal) {
  return goal.end_effector_id;
}
inline const Eigen::Vector3d& TargetOf(const AimGoal& goal) {
  return goal.world_point;
}
inline void Retarget(AimGoal& goal, const Eigen::Vector3d& target) {
  goal.world_point = target;
}

void CheckAndNormalize(AimGoal& goal, Violations& violations);
void CheckOn(const Skeleton& skeleton, AimGoal& goal, Violations& violations);

// What it looks at; `goal` has passed CheckOn.
EffectorTask TaskOf(const Skeleton& skeleton, const AimGoal& goal);
// The part that moves, and the part that does not.
void StoreTarget(const AimGoal& goal, kernel::TaskTarget& target);
void StoreRows(const AimGoal& goal, double weight, kernel::TaskTarget& target);

void LinearizeAim(const kernel::TaskTarget& target,
                  const kernel::GoalFrame* frames, kernel::GoalRows& rows);

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_AIM_GOAL_H_
