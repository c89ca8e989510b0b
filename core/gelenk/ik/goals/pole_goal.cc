#include "gelenk/ik/goals/pole_goal.h"

#include "absl/strings/str_cat.h"
#include "gelenk/ik/goals/goal_check.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

// -1, and a violation, when there is none.
int FindJoint(const Skeleton& skeleton, absl::string_view field,
              absl::string_view id, Violations& violations) {
  const int joint = skeleton.FindJoint(id);
  if (joint < 0) {
    violations.Add(field, absl::StrCat("no joint ", QuotedId(id)));
  }
  return joint;
}

bool IsBelow(const Skeleton& skeleton, int joint, int ancestor) {
  do {
    joint = skeleton.span(joint).parent;
  } while (joint > ancestor);  // Parents come first.
  return joint == ancestor;
}

}  // namespace

void CheckAndNormalize(PoleGoal& goal, Violations& violations) {
  CheckPoint("world_point", goal.world_point, violations);
}

void CheckOn(const Skeleton& skeleton, PoleGoal& goal, Violations& violations) {
  const int root =
      FindJoint(skeleton, "root_joint_id", goal.root_joint_id, violations);
  const int mid =
      FindJoint(skeleton, "mid_joint_id", goal.mid_joint_id, violations);
  const int tip =
      FindJoint(skeleton, "tip_joint_id", goal.tip_joint_id, violations);
  if (root >= 0 && mid >= 0 && !IsBelow(skeleton, mid, root)) {
    violations.Add("mid_joint_id",
                   absl::StrCat(QuotedId(goal.mid_joint_id), " is not below ",
                                QuotedId(goal.root_joint_id)));
  }
  if (mid >= 0 && tip >= 0 && !IsBelow(skeleton, tip, mid)) {
    violations.Add("tip_joint_id",
                   absl::StrCat(QuotedId(goal.tip_joint_id), " is not below ",
                                QuotedId(goal.mid_joint_id)));
  }
}

}  // namespace gelenk
