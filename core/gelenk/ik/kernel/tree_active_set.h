// Which columns of a tree are held by their bounds.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_TREE_ACTIVE_SET_H_
#define GELENK_IK_KERNEL_TREE_ACTIVE_SET_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/base/kernel/scalar.h"
#include "gelenk/ik/kernel/rotation_bounds.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/kernel/tree_state.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

GELENK_INLINE bool IsBlockedRotation(const TreeState& state,
                                     const Column& column, int c, double g) {
  const Node& node = state.tree.nodes[column.node];
  const int first = node.axis + (node.type == NodeType::kFree ? 3 : 0);
  return BlocksTurn(state.work.touched[column.node], c - first, g);
}

// Marks the columns that sit at a bound and are pushed outwards; they do not
// move in this step. Returns whether any is pushed with force.
inline bool BlockColumns(const TreeState& state) {
  double largest = 0;
  double pushed = 0;
  for (int c = 0; c < state.tree.column_count; ++c) {
    const Column& column = state.tree.columns[c];
    double& g = state.work.gradient[c];
    bool blocked = false;
    if (column.position >= 0) {
      const double value = state.q[column.position];
      const double lower = state.settings.lower[c],
                   upper = state.settings.upper[c];
      blocked = (value <= lower && g < 0) || (value >= upper && g > 0) ||
                lower == upper;
    } else if (state.work.touched[column.node] != 0) {
      blocked = IsBlockedRotation(state, column, c, g);
    }
    state.work.blocked[c] = blocked;
    if (blocked) {
      pushed = Max(pushed, Abs(g));
      g = 0;
    } else {
      largest = Max(largest, Abs(g));
    }
  }
  return pushed > 0 && pushed > 10 * largest;
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_TREE_ACTIVE_SET_H_
