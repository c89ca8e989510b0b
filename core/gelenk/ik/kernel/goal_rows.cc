#include "gelenk/ik/kernel/goal_rows.h"

#include "gelenk/ik/goals/aim_goal.h"
#include "gelenk/ik/goals/half_space_goal.h"
#include "gelenk/ik/goals/pole_goal.h"
#include "gelenk/ik/goals/pose_rows.h"
#include "gelenk/ik/goals/relative_goal.h"

namespace gelenk::kernel {

void LinearizeGoal(const TaskTarget& target, const GoalFrame* frames,
                   GoalRows& rows) {
  switch (target.shape) {
    case GoalShape::kNone:
      rows.rotation_energy = 0;
      rows.position_error2 = 0;
      rows.rotation_error2 = 0;
      return;
    case GoalShape::kPose:
    case GoalShape::kCenterOfMass:
      return LinearizePose(target, frames[0], rows);
    case GoalShape::kPartialPose:
      return LinearizePartialPose(target, frames[0], rows);
    case GoalShape::kAim:
      return LinearizeAim(target, frames, rows);
    case GoalShape::kPole:
      return LinearizePole(target, frames, rows);
    case GoalShape::kHalfSpace:
      return LinearizeHalfSpace(target, frames, rows);
    case GoalShape::kRelative:
      return LinearizeRelative(target, frames, rows);
  }
}

}  // namespace gelenk::kernel
