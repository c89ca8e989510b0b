// Stay on one side of a plane: feet above the ground. World frame, m.
#ifndef GELENK_IK_GOALS_HALF_SPACE_GOAL_H_
#define GELENK_IK_GOALS_HALF_SPACE_GOAL_H_

#include <Eigen/Core>
#include <string>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/effector_task.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// The points p with normal . p = offset_m; its free side is where it is more.
struct Plane {
  // Any length but zero, normalised.
  Eigen::Vector3d world_normal = Eigen::Vector3d::UnitY();
  // Signed distance from the world's origin along the normal.
  double offset_m = 0;
};

// Without effect while the end effector's origin is on the free side.
struct HalfSpaceGoal {
  std::string end_effector_id;
  // As in Plane.
  Eigen::Vector3d world_normal = Eigen::Vector3d::UnitY();
  double offset_m = 0;
  // The plane is the ground: through the world's origin, normal to the
  // skeleton's up. CheckOn puts it in the place of what stands above.
  bool is_ground = false;
};

inline absl::string_view KindName(const HalfSpaceGoal&) { return "half_space"; }
inline absl::string_view EffectorId(const HalfSpaceGoal& goal) {
  return goal.end_effector_id;
}
inline Plane TargetOf(const HalfSpaceGoal& goal) {
  return {goal.world_normal, goal.offset_m};
}
inline void Retarget(HalfSpaceGoal& goal, const Plane& target) {
  goal.world_normal = target.world_normal;
  goal.offset_m = target.offset_m;
  goal.is_ground = false;
}

void CheckAndNormalize(Plane& plane, Violations& violations);
void CheckAndNormalize(HalfSpaceGoal& goal, Violations& violations);
void CheckOn(const Skeleton& skeleton, HalfSpaceGoal& goal,
             Violations& violations);

// What it looks at; `goal` has passed CheckOn.
EffectorTask TaskOf(const Skeleton& skeleton, const HalfSpaceGoal& goal);
// The part that moves, and the part that does not.
void StoreTarget(const HalfSpaceGoal& goal, kernel::TaskTarget& target);
void StoreRows(const HalfSpaceGoal& goal, double weight,
               kernel::TaskTarget& target);

void LinearizeHalfSpace(const kernel::TaskTarget& target,
                        const kernel::GoalFrame* frames,
                        kernel::GoalRows& rows);

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_HALF_SPACE_GOAL_H_
