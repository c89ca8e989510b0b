// Turn the bend of a two-bone limb (knee, elbow) into the half-plane of a
// point. World frame, m.
#ifndef GELENK_IK_GOALS_POLE_GOAL_H_
#define GELENK_IK_GOALS_POLE_GOAL_H_

#include <Eigen/Core>
#include <string>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/effector_task.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct PoleGoal {
  // Hip or shoulder, knee or elbow, ankle or wrist: each an ancestor of the
  // next.
  std::string root_joint_id;
  std::string mid_joint_id;
  std::string tip_joint_id;
  Eigen::Vector3d world_point = Eigen::Vector3d::Zero();
};

inline absl::string_view KindName(const PoleGoal&) { return "pole"; }
inline absl::string_view EffectorId(const PoleGoal& goal) {
  return goal.tip_joint_id;
}
inline const Eigen::Vector3d& TargetOf(const PoleGoal& goal) {
  return goal.world_point;
}
inline void Retarget(PoleGoal& goal, const Eigen::Vector3d& target) {
  goal.world_point = target;
}

void CheckAndNormalize(PoleGoal& goal, Violations& violations);
void CheckOn(const Skeleton& skeleton, PoleGoal& goal, Violations& violations);

// What it looks at; `goal` has passed CheckOn.
EffectorTask TaskOf(const Skeleton& skeleton, const PoleGoal& goal);
// The part that moves, and the part that does not.
void StoreTarget(const PoleGoal& goal, kernel::TaskTarget& target);
void StoreRows(const PoleGoal& goal, double weight, kernel::TaskTarget& target);

void LinearizePole(const kernel::TaskTarget& target,
                   const kernel::GoalFrame* frames, kernel::GoalRows& rows);

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_POLE_GOAL_H_
