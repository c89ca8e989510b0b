// Brings joints into an order with parents first, as far as they are a tree.
#ifndef GELENK_SKELETON_JOINT_ORDER_H_
#define GELENK_SKELETON_JOINT_ORDER_H_

#include <vector>

#include "absl/types/span.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint.h"

namespace gelenk {

// The indices of `joints` with parents first; the given order where that has
// them first already. Reports duplicate ids, unknown parents, cycles, paths
// from the root longer than `max_depth` joints, and none or several roots, as
// "joints[i].parent_joint_id"; the order means nothing then. Cost: linear.
std::vector<int> OrderParentsFirst(absl::Span<const Joint> joints,
                                   int max_depth, Violations& violations);

}  // namespace gelenk

#endif  // GELENK_SKELETON_JOINT_ORDER_H_
