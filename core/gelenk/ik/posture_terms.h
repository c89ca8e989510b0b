// Posture goals as the solvers take them: one pull per number of q and per
// rotation, all goals of a level joined.
//
// Joining is exact: sums of squares of a number have one minimum, and so have
// sums of 4 (1 - cos(angle / 2)), which are linear in the quaternion; up to a
// constant they are one term again.
#ifndef GELENK_IK_POSTURE_TERMS_H_
#define GELENK_IK_POSTURE_TERMS_H_

#include <optional>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/ik/goal.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

// Replaces `terms` by those of the goals that are on and of `priority` (of any,
// when unset). `first_columns` has the first column of each joint, -1 for one
// that has none; terms of those come last. Returns the number of the others.
// Allocates only when `terms` grows. Cost: linear in joints and postures.
int JoinPostures(const Skeleton& skeleton, absl::Span<const Goal> goals,
                 std::optional<int> priority,
                 absl::Span<const int> first_columns,
                 std::vector<kernel::PostureTerm>& terms);

// Moves the numbers of `terms` to where they pull.
void TakePosture(absl::Span<const kernel::PostureTerm> terms,
                 VectorView positions);

}  // namespace gelenk

#endif  // GELENK_IK_POSTURE_TERMS_H_
