#include "gelenk/ik/goals/half_space_goal.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "gelenk/ik/goals/goal_check.h"

namespace gelenk {

void CheckAndNormalize(Plane& plane, Violations& violations) {
  CheckDirection("world_normal", plane.world_normal, violations);
  if (std::isfinite(plane.offset_m)) return;
  violations.Add("offset_m",
                 absl::StrCat("want a finite number, got ", plane.offset_m));
}

void CheckAndNormalize(HalfSpaceGoal& goal, Violations& violations) {
  Plane plane = TargetOf(goal);
  CheckAndNormalize(plane, violations);
  goal.world_normal = plane.world_normal;
}

void CheckOn(const Skeleton& skeleton, HalfSpaceGoal& goal,
             Violations& violations) {
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
  if (!goal.is_ground) return;
  goal.world_normal = skeleton.up();
  goal.offset_m = 0;
}

}  // namespace gelenk
