// A serial chain with one position goal, laid out for the kernel that takes a
// step in O(n): the owner of the arrays behind kernel::ChainLayout.
//
// Immutable, safe to read from any thread. Cost: linear in the nodes.
#ifndef GELENK_IK_SERIAL_CHAIN_H_
#define GELENK_IK_SERIAL_CHAIN_H_

#include <optional>
#include <vector>

#include "gelenk/ik/kernel/chain_layout.h"
#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk {

class SerialChain {
 public:
  // None when `tree` is anything else: several tasks, one that wants a
  // rotation, mimic joints, or joints other than revolute, prismatic and
  // spherical ones. Keeps a reference to the tree's rotation limits.
  static std::optional<SerialChain> Of(const kernel::TreeLayout& tree);

  kernel::ChainLayout Layout() const;

  bool has_spherical() const { return has_spherical_; }

  size_t ByteSize() const {
    return steps_.capacity() * sizeof(kernel::ChainStep);
  }

 private:
  explicit SerialChain(const kernel::TreeLayout& tree);

  std::vector<kernel::ChainStep> steps_;
  kernel::ChainLayout layout_ = {};
  bool has_spherical_ = false;
};

}  // namespace gelenk

#endif  // GELENK_IK_SERIAL_CHAIN_H_
