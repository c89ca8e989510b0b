// One attempt on a tree: what it is asked, what it works in, and where it is.
// The pieces of the kernel of trees are functions of it.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_TREE_STATE_H_
#define GELENK_IK_KERNEL_TREE_STATE_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

struct TreeState {
  const TreeLayout& tree;
  const TaskTarget* const targets;
  const Settings& settings;
  const Workspace& work;
  double* const q;

  // World frame of a node, or of the base for -1; known once ForwardPass ran.
  GELENK_INLINE const double* RotationOf(int node) const {
    return node < 0 ? settings.base_rotation : work.node_rotation + 9 * node;
  }
  GELENK_INLINE const double* TranslationOf(int node) const {
    return node < 0 ? settings.base_translation
                    : work.node_translation + 3 * node;
  }
};

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_TREE_STATE_H_
