// A skeleton reduced to what moves the effectors of some goals: the owner of
// the arrays behind kernel::TreeLayout.
//
// Depends on which effectors the goals name and on which rows they use, not on
// targets or weights. Built once per problem; cost: linear in joints times
// goals. Immutable, safe to read from any thread.
#ifndef GELENK_IK_SPARSE_TREE_H_
#define GELENK_IK_SPARSE_TREE_H_

#include <memory>
#include <optional>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/ik/bone_chain.h"
#include "gelenk/ik/effector_task.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/serial_arm.h"
#include "gelenk/ik/serial_chain.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// True when all frames of `task` lie between the root and one of them, so that
// its rows fill one path. What couples branches is not for a sparse tree: to it
// such a task has no rows.
bool IsOnOnePath(const Skeleton& skeleton, const EffectorTask& task);

class SparseTree {
 public:
  SparseTree(const Skeleton& skeleton, absl::Span<const EffectorTask> tasks);

  // Valid as long as this object stays where it is.
  kernel::TreeLayout Layout() const;

  // Index in the skeleton of the joint behind a node.
  int joint_of(int node) const { return joints_of_nodes_[node]; }

  // Index in the skeleton of the joint whose degree of freedom a column is.
  int joint_of_column(int column) const { return joints_of_columns_[column]; }

  absl::Span<const int> joints_of_nodes() const { return joints_of_nodes_; }

  // For solvers of chains; null when these tasks make none of that kind.
  const SerialChain* chain() const { return chain_ ? &*chain_ : nullptr; }
  // Null when these tasks are not that of one arm.
  const SerialArm* arm() const { return arm_.get(); }
  const BoneChain* bones() const { return bones_ ? &*bones_ : nullptr; }

  size_t ByteSize() const;

 private:
  friend class SparseTreeBuilder;

  std::vector<kernel::Node> nodes_;
  std::vector<kernel::RotationLimit> rotation_limits_;
  std::vector<kernel::Column> columns_;
  std::vector<double> lower_;  // per column
  std::vector<double> upper_;
  std::vector<kernel::PathColumn> path_columns_;
  std::vector<kernel::PathFollower> followers_;
  std::vector<kernel::Task> tasks_;
  std::vector<kernel::TaskFrame> frames_;
  std::vector<int> joints_of_nodes_;
  std::vector<int> joints_of_columns_;
  std::optional<SerialChain> chain_;
  std::unique_ptr<const SerialArm> arm_;
  std::optional<BoneChain> bones_;
  int axis_count_ = 0;
  int h_size_ = 0;
  int j_size_ = 0;
  int position_count_ = 0;
  int shaped_count_ = 0;
};

}  // namespace gelenk

#endif  // GELENK_IK_SPARSE_TREE_H_
