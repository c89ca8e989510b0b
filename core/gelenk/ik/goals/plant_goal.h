// Do not move from where it is when the goal is switched on: a foot on the
// ground. m, rad.
#ifndef GELENK_IK_GOALS_PLANT_GOAL_H_
#define GELENK_IK_GOALS_PLANT_GOAL_H_

#include <string>
#include <variant>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/effector_task.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// Switched on when its weight goes from 0 to more, or when its problem is made
// with a weight. The pose that it holds is the end effector's, in the world, at
// the start of the next solve (see IkProblem::CapturePlants).
struct PlantGoal {
  std::string end_effector_id;
  // What one radian counts against one metre; 0 leaves the rotation free.
  double rotation_scale_m_per_rad = 1;
};

inline absl::string_view KindName(const PlantGoal&) { return "plant"; }
inline absl::string_view EffectorId(const PlantGoal& goal) {
  return goal.end_effector_id;
}
// Nobody gives it a target.
inline std::monostate TargetOf(const PlantGoal&) { return {}; }
inline void Retarget(PlantGoal&, std::monostate) {}

void CheckAndNormalize(PlantGoal& goal, Violations& violations);
void CheckOn(const Skeleton& skeleton, PlantGoal& goal, Violations& violations);

// What it looks at; `goal` has passed CheckOn.
EffectorTask TaskOf(const Skeleton& skeleton, const PlantGoal& goal);
// The part that moves, and the part that does not.
void StoreTarget(const PlantGoal& goal, kernel::TaskTarget& target);
void StoreRows(const PlantGoal& goal, double weight,
               kernel::TaskTarget& target);

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_PLANT_GOAL_H_
