#include "gelenk/ik/goals/posture_goal.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/ik/goals/goal_check.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

void CheckAndNormalize(PostureGoal& goal, Violations& violations) {
  for (size_t i = 0; i < goal.joint_weights.size(); ++i) {
    CheckNotNegative(absl::StrCat("joint_weights[", i, "]"),
                     goal.joint_weights[i], violations);
  }
}

void CheckOn(const Skeleton& skeleton, PostureGoal& goal,
             Violations& violations) {
  violations.AddStatus("", CheckPositions(skeleton, goal.positions));
  const size_t given = goal.joint_weights.size();
  if (given != 0 && given != static_cast<size_t>(skeleton.joint_count())) {
    violations.Add("joint_weights",
                   absl::StrFormat("want %d numbers or none, got %d",
                                   skeleton.joint_count(), given));
  }
}

}  // namespace gelenk
