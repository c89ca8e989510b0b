// Stay near a pose. It pulls, and never decides on the outcome.
#ifndef GELENK_IK_GOALS_POSTURE_GOAL_H_
#define GELENK_IK_GOALS_POSTURE_GOAL_H_

#include <Eigen/Core>
#include <vector>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/effector_task.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct PostureGoal {
  // A pose of the skeleton: size position_count, quaternions near unit are
  // normalised. It may break limits.
  Eigen::VectorXd positions;
  // Per joint of the skeleton, >= 0, per rad^2 or m^2; empty means 1
  // everywhere. That of a mimic joint has no effect.
  std::vector<double> joint_weights;
};

inline absl::string_view KindName(const PostureGoal&) { return "posture"; }
inline absl::string_view EffectorId(const PostureGoal&) { return {}; }
inline const Eigen::VectorXd& TargetOf(const PostureGoal& goal) {
  return goal.positions;
}
// Allocates nothing when the size stays.
inline void Retarget(PostureGoal& goal, const Eigen::VectorXd& target) {
  goal.positions = target;
}

void CheckAndNormalize(PostureGoal& goal, Violations& violations);
void CheckOn(const Skeleton& skeleton, PostureGoal& goal,
             Violations& violations);

// It is no function of a few frames.
inline EffectorTask TaskOf(const Skeleton&, const PostureGoal&) { return {}; }
inline void StoreTarget(const PostureGoal&, kernel::TaskTarget&) {}
inline void StoreRows(const PostureGoal&, double, kernel::TaskTarget&) {}

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_POSTURE_GOAL_H_
