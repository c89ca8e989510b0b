// Checks the goals of a problem one after another and collects what is wrong
// with any of them, so that a caller sees it all at once.
//
// Violations name goals[<index>] in the order of the calls. Normalises as
// CheckAndNormalize and CheckOn do. Cost: linear in the goals.
#ifndef GELENK_IK_GOAL_LIST_CHECK_H_
#define GELENK_IK_GOAL_LIST_CHECK_H_

#include <cstddef>
#include <string>

#include "absl/container/flat_hash_set.h"
#include "absl/status/status.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/goal.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// As CheckAndNormalize for a goal whose kind is missing: that is a violation
// too.
absl::Status CheckWithoutKind(const Goal& goal);

class GoalListCheck {
 public:
  // Without a skeleton only what needs none is checked. Both outlive this.
  GoalListCheck(const Skeleton* skeleton, Violations& violations)
      : skeleton_(skeleton), violations_(violations) {}

  // Whether so many goals may be asked for at all.
  bool AddCount(size_t count);

  // True when nothing is wrong with `goal` by itself; then it names what its
  // skeleton has.
  bool Add(Goal& goal);

  // A goal whose kind is missing: the rest of it is checked.
  void AddWithoutKind(const Goal& goal);

 private:
  void AddId(const std::string& field, const Goal& goal);

  const Skeleton* skeleton_;
  Violations& violations_;
  absl::flat_hash_set<std::string> ids_;
  int count_ = 0;
};

}  // namespace gelenk

#endif  // GELENK_IK_GOAL_LIST_CHECK_H_
