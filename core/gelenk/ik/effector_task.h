// What one goal looks at, before any target: which frames of the skeleton, and
// how many rows it makes of them.
#ifndef GELENK_IK_EFFECTOR_TASK_H_
#define GELENK_IK_EFFECTOR_TASK_H_

#include <array>

#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct EffectorTask {
  kernel::GoalShape shape = kernel::GoalShape::kNone;
  int translation_rows = 0;
  int rotation_rows = 0;
  int frame_count = 0;
  std::array<EffectorFrame, kernel::kMaxGoalFrames> frames;

  // Whether turning a frame about its own origin makes no difference.
  bool points_only() const {
    return rotation_rows == 0 || shape == kernel::GoalShape::kPole;
  }
};

}  // namespace gelenk

#endif  // GELENK_IK_EFFECTOR_TASK_H_
