// The targets of goals as the pose of a skeleton, so that what works on poses
// (filters, jitter buffers) works on targets: a free joint for each goal, of
// which a point uses the translation, an orientation the rotation.
//
// Goals whose target is none of a point, a rotation or a pose have a joint that
// nobody moves. Immutable; cost of all but Create: linear in the goals, and
// nothing is allocated.
#ifndef GELENK_IK_TARGET_RIG_H_
#define GELENK_IK_TARGET_RIG_H_

#include <Eigen/Core>
#include <memory>

#include "absl/types/span.h"
#include "gelenk/ik/goal.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

class TargetRig {
 public:
  explicit TargetRig(int goal_count);

  const std::shared_ptr<const Skeleton>& skeleton() const { return skeleton_; }

  // Where the goals' targets are.
  Eigen::VectorXd PositionsOf(absl::Span<const Goal> goals) const;

  // Whether there is a place for that sort of target.
  static bool Takes(const GoalTarget& target);

  // Puts a target into `positions`; others are left out.
  void Put(int goal_index, const GoalTarget& target,
           VectorView positions) const;

  // Gives the goals of `problem`, as many as the rig has, their targets.
  void Aim(const ConstVectorView& positions, IkProblem& problem) const;

 private:
  std::shared_ptr<const Skeleton> skeleton_;
};

}  // namespace gelenk

#endif  // GELENK_IK_TARGET_RIG_H_
