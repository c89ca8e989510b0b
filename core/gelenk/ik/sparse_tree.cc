#include "gelenk/ik/sparse_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

using kernel::Node;
using kernel::NodeType;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Something must hold a joint that moves no effector in its present pose.
constexpr double kLeastStiffness = 1e-6;

void StoreMatrix(const Eigen::Matrix3d& m, kernel::Matrix3& out) {
  for (int i = 0; i < 9; ++i) out[i] = m(i / 3, i % 3);
}

void StoreVector(const Eigen::Vector3d& v, kernel::Vector3& out) {
  for (int i = 0; i < 3; ++i) out[i] = v[i];
}

NodeType NodeTypeOf(JointType type) {
  switch (type) {
    case JointType::kPrismatic:
      return NodeType::kPrismatic;
    case JointType::kSpherical:
      return NodeType::kSpherical;
    case JointType::kPlanar:
      return NodeType::kPlanar;
    case JointType::kFree:
      return NodeType::kFree;
    default:
      return NodeType::kRevolute;
  }
}

bool TurnsOnly(JointType type) {
  return type == JointType::kRevolute || type == JointType::kSpherical;
}

// A joint's frame turned so that its axis is z.
RigidTransform JointFromNode(const Joint& joint) {
  if (!NeedsAxis(joint.type)) return {};
  return {Eigen::Quaterniond(PlanarBasis(joint.axis)).normalized(),
          Eigen::Vector3d::Zero()};
}

kernel::RotationLimit RotationLimitOf(const Joint& joint) {
  const JointLimits& limits = joint.limits;
  kernel::RotationLimit out = {};
  StoreVector(joint.axis, out.axis);
  out.swing_cone = limits.swing_cone_rad.value_or(kInfinity);
  const double half_cone = 0.5 * std::min(out.swing_cone, std::numbers::pi);
  out.swing_sine2 = std::isfinite(out.swing_cone)
                        ? std::sin(half_cone) * std::sin(half_cone)
                        : kInfinity;
  const std::optional<TwistRange> twist = TwistRangeOf(limits);
  out.twist_lower = twist ? twist->lower_rad : -kInfinity;
  out.twist_upper = twist ? twist->upper_rad : kInfinity;
  constexpr double kHalfTurn = std::numbers::pi - 1e-3;
  out.quick =
      !twist || (out.twist_lower > -kHalfTurn && out.twist_upper < kHalfTurn);
  out.twist_tangent_lower = twist ? std::tan(0.5 * out.twist_lower)
                                  : -std::numeric_limits<double>::max();
  out.twist_tangent_upper = twist ? std::tan(0.5 * out.twist_upper)
                                  : std::numeric_limits<double>::max();
  return out;
}

bool IsAtOrAbove(const Skeleton& skeleton, int ancestor, int joint) {
  while (joint > ancestor) joint = skeleton.span(joint).parent;
  return joint == ancestor;
}

}  // namespace

bool IsOnOnePath(const Skeleton& skeleton, const EffectorTask& task) {
  int deepest = -1;
  for (int f = 0; f < task.frame_count; ++f) {
    deepest = std::max(deepest, task.frames[f].joint);
  }
  for (int f = 0; f < task.frame_count; ++f) {
    if (!IsAtOrAbove(skeleton, task.frames[f].joint, deepest)) return false;
  }
  return true;
}

class SparseTreeBuilder {
 public:
  SparseTreeBuilder(const Skeleton& skeleton,
                    absl::Span<const EffectorTask> tasks, SparseTree& tree)
      : skeleton_(skeleton),
        tasks_(tasks.begin(), tasks.end()),
        tree_(tree),
        node_of_joint_(skeleton.joint_count(), -1),
        home_of_joint_(skeleton.joint_count(), kNowhere),
        column_of_joint_(skeleton.joint_count(), -1) {}

  void Build() {
    for (EffectorTask& task : tasks_) {
      if (!IsOnOnePath(skeleton_, task)) task = EffectorTask();
      if (!task.points_only()) continue;
      for (int f = 0; f < task.frame_count; ++f) Shorten(task.frames[f]);
    }
    AddNodes();
    PlaceColumns();
    AddMimicAxes();
    for (const EffectorTask& task : tasks_) AddTask(task);
    PackRows();
    tree_.position_count_ = skeleton_.position_count();
    GiveBackSpareMemory();
  }

 private:
  static constexpr int kBase = -1;
  static constexpr int kNowhere = -2;

  int Parent(int joint) const { return skeleton_.span(joint).parent; }
  bool Moves(int joint) const {
    return skeleton_.joint(joint).type != JointType::kFixed;
  }

  // A point at the origin of a turning joint is not moved by that joint: hang
  // it on the parent.
  void Shorten(EffectorFrame& effector) const {
    while (Parent(effector.joint) >= 0) {
      const Joint& joint = skeleton_.joint(effector.joint);
      const bool at_origin =
          effector.joint_from_effector.translation.norm() < 1e-12;
      if (!(TurnsOnly(joint.type) && at_origin)) return;
      effector.joint_from_effector = joint.parent_from_joint;
      effector.joint = Parent(effector.joint);
    }
  }

  // The nearest node at or above `joint`, and where `joint` is from it.
  int NodeAbove(int joint, RigidTransform& node_from_joint) const {
    node_from_joint = RigidTransform();
    while (joint >= 0 && !Moves(joint)) {
      node_from_joint =
          skeleton_.joint(joint).parent_from_joint * node_from_joint;
      joint = Parent(joint);
    }
    if (joint < 0) return kBase;
    node_from_joint =
        JointFromNode(skeleton_.joint(joint)).Inverse() * node_from_joint;
    return node_of_joint_[joint];
  }

  void AddNodes() {
    std::vector<bool> active(skeleton_.joint_count(), false);
    for (const EffectorTask& task : tasks_) {
      for (int f = 0; f < task.frame_count; ++f) {
        int j = task.frames[f].joint;
        for (; j >= 0 && !active[j]; j = Parent(j)) active[j] = true;
      }
    }
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      if (active[j] && Moves(j)) AddNode(j);
    }
  }

  void AddNode(int j) {
    const Joint& joint = skeleton_.joint(j);
    const JointSpan& span = skeleton_.span(j);
    Node node = {};
    RigidTransform node_from_parent_joint;
    node.parent = span.parent < 0
                      ? kBase
                      : NodeAbove(span.parent, node_from_parent_joint);
    const RigidTransform parent_from_rest =
        node_from_parent_joint * joint.parent_from_joint * JointFromNode(joint);
    StoreMatrix(parent_from_rest.rotation.toRotationMatrix(),
                node.parent_from_rest_rotation);
    StoreVector(parent_from_rest.translation,
                node.parent_from_rest_translation);
    node.offset_is_translation = parent_from_rest.rotation.vec().norm() < 1e-15;
    node.type = NodeTypeOf(joint.type);
    node.mimics = span.mimicked >= 0;
    node.multiplier = node.mimics ? joint.mimic->multiplier : 1;
    node.offset = node.mimics ? joint.mimic->offset : 0;
    const int owner = node.mimics ? span.mimicked : j;
    node.position = skeleton_.span(owner).position_offset;
    node.limits_rotation = joint.limits.HasRotationLimits();
    tree_.rotation_limits_.push_back(node.limits_rotation
                                         ? RotationLimitOf(joint)
                                         : kernel::RotationLimit{});
    node_of_joint_[j] = static_cast<int>(tree_.nodes_.size());
    tree_.nodes_.push_back(node);
    tree_.joints_of_nodes_.push_back(j);
    // The column of a followed joint hangs above everything that it moves.
    int& home = home_of_joint_[owner];
    home = home == kNowhere ? node_of_joint_[j]
                            : CommonAncestor(home, node_of_joint_[j]);
  }

  int CommonAncestor(int a, int b) const {
    while (a != b) (a > b ? a : b) = tree_.nodes_[std::max(a, b)].parent;
    return a;
  }

  // Numbers the columns parents first by their homes.
  void PlaceColumns() {
    columns_at_.resize(tree_.nodes_.size() + 1);
    for (int home = kBase; home < static_cast<int>(tree_.nodes_.size());
         ++home) {
      for (int j = 0; j < skeleton_.joint_count(); ++j) {
        if (home_of_joint_[j] == home) AddColumns(j, home);
      }
    }
    tree_.axis_count_ = static_cast<int>(tree_.columns_.size());
  }

  void AddColumns(int j, int home) {
    const Joint& joint = skeleton_.joint(j);
    const int count = VelocityCount(joint.type);
    column_of_joint_[j] = static_cast<int>(tree_.columns_.size());
    tree_.joints_of_columns_.resize(tree_.columns_.size() + count, j);
    if (node_of_joint_[j] >= 0) {
      tree_.nodes_[node_of_joint_[j]].axis = column_of_joint_[j];
    }
    for (int k = 0; k < count; ++k) {
      columns_at_[home + 1].push_back(static_cast<int>(tree_.columns_.size()));
      tree_.columns_.push_back(MakeColumn(j, k));
    }
  }

  kernel::Column MakeColumn(int j, int k) {
    const Joint& joint = skeleton_.joint(j);
    kernel::Column column = {};
    column.node = node_of_joint_[j];
    const bool quaternion = joint.type == JointType::kSpherical ||
                            (joint.type == JointType::kFree && k >= 3);
    column.position = quaternion ? -1 : skeleton_.span(j).position_offset + k;
    const PositionBounds& bounds = skeleton_.position_bounds();
    tree_.lower_.push_back(quaternion ? -kInfinity
                                      : bounds.lower[column.position]);
    tree_.upper_.push_back(quaternion ? kInfinity
                                      : bounds.upper[column.position]);
    column.stiffness = std::max(
        joint.stiffness.empty() ? 1 : joint.stiffness[k], kLeastStiffness);
    return column;
  }

  void AddMimicAxes() {
    for (Node& node : tree_.nodes_) {
      if (node.mimics) node.axis = tree_.axis_count_++;
    }
  }

  kernel::TaskFrame FrameOnNode(const EffectorFrame& effector) const {
    kernel::TaskFrame frame = {};
    RigidTransform node_from_joint;
    frame.node = NodeAbove(effector.joint, node_from_joint);
    const RigidTransform node_from_effector =
        node_from_joint * effector.joint_from_effector;
    StoreMatrix(node_from_effector.rotation.toRotationMatrix(),
                frame.node_from_frame_rotation);
    StoreVector(node_from_effector.translation,
                frame.node_from_frame_translation);
    return frame;
  }

  // The rest of a task but its path.
  kernel::Task MakeTask(const EffectorTask& effector_task) {
    kernel::Task task = {};
    task.shape = effector_task.shape;
    task.frame_begin = static_cast<int>(tree_.frames_.size());
    task.frame_count = effector_task.frame_count;
    if (task.shape != kernel::GoalShape::kPose) {
      task.shaped = tree_.shaped_count_++;
      task.row_end =
          effector_task.translation_rows + effector_task.rotation_rows;
    } else {
      task.row_begin = effector_task.translation_rows > 0 ? 0 : 3;
      task.row_end = effector_task.rotation_rows > 0 ? 6 : 3;
    }
    task.node = kBase;
    for (int f = 0; f < task.frame_count; ++f) {
      const kernel::TaskFrame frame = FrameOnNode(effector_task.frames[f]);
      if (frame.node >= task.node) {
        task.node = frame.node;
        std::copy_n(frame.node_from_frame_rotation, 9,
                    task.node_from_effector_rotation);
        std::copy_n(frame.node_from_frame_translation, 3,
                    task.node_from_effector_translation);
      }
      if (task.shape != kernel::GoalShape::kPose) {
        tree_.frames_.push_back(frame);
      }
    }
    return task;
  }

  void AddTask(const EffectorTask& effector_task) {
    kernel::Task task = MakeTask(effector_task);
    std::vector<int> chain;
    for (int n = task.node; n >= 0; n = tree_.nodes_[n].parent) {
      chain.push_back(n);
    }
    chain.push_back(kBase);
    std::reverse(chain.begin(), chain.end());
    task.path_begin = static_cast<int>(tree_.path_columns_.size());
    for (int home : chain) {
      for (int c : columns_at_[home + 1]) AddToPath(c, chain);
    }
    task.path_size =
        static_cast<int>(tree_.path_columns_.size()) - task.path_begin;
    task.follower_begin = static_cast<int>(tree_.followers_.size());
    for (int n : chain) {
      if (n >= 0 && tree_.nodes_[n].mimics) AddFollower(n, task);
    }
    task.follower_count =
        static_cast<int>(tree_.followers_.size()) - task.follower_begin;
    tree_.j_size_ += 6 * kernel::PaddedRow(task.path_size);
    tree_.tasks_.push_back(task);
  }

  void AddToPath(int c, const std::vector<int>& chain) {
    const kernel::Column& column = tree_.columns_[c];
    kernel::PathColumn place = {};
    place.column = c;
    place.node = column.node;
    place.absent =
        std::find(chain.begin(), chain.end(), column.node) == chain.end() ||
        column.node < 0;
    if (!place.absent) {
      const Node& node = tree_.nodes_[column.node];
      const int k = c - node.axis;
      place.rotation = node.type == NodeType::kRevolute ||
                       node.type == NodeType::kSpherical ||
                       (node.type == NodeType::kPlanar && k == 2) ||
                       (node.type == NodeType::kFree && k >= 3);
    }
    tree_.path_columns_.push_back(place);
  }

  void AddFollower(int n, const kernel::Task& task) {
    const Node& node = tree_.nodes_[n];
    const int owner = skeleton_.span(tree_.joints_of_nodes_[n]).mimicked;
    for (int k = 0; k < task.path_size; ++k) {
      if (tree_.path_columns_[task.path_begin + k].column !=
          column_of_joint_[owner]) {
        continue;
      }
      tree_.followers_.push_back(
          {k, node.axis, n, node.type == NodeType::kRevolute, node.multiplier});
      return;
    }
  }

  // Depth, ancestors and packed row of each column, from any path that has it.
  void PackRows() {
    for (const kernel::Task& task : tree_.tasks_) {
      for (int k = 0; k < task.path_size; ++k) {
        const int c = tree_.path_columns_[task.path_begin + k].column;
        tree_.columns_[c].depth = k;
        tree_.columns_[c].ancestors = task.path_begin;
      }
    }
    for (kernel::Column& column : tree_.columns_) {
      column.row = tree_.h_size_;
      tree_.h_size_ += kernel::PaddedRow(column.depth + 1);
    }
  }

  // Trees live as long as sessions do.
  void GiveBackSpareMemory() {
    tree_.nodes_.shrink_to_fit();
    tree_.rotation_limits_.shrink_to_fit();
    tree_.columns_.shrink_to_fit();
    tree_.lower_.shrink_to_fit();
    tree_.upper_.shrink_to_fit();
    tree_.path_columns_.shrink_to_fit();
    tree_.followers_.shrink_to_fit();
    tree_.tasks_.shrink_to_fit();
    tree_.frames_.shrink_to_fit();
    tree_.joints_of_nodes_.shrink_to_fit();
  }

  const Skeleton& skeleton_;
  std::vector<EffectorTask> tasks_;
  SparseTree& tree_;
  std::vector<int> node_of_joint_;
  std::vector<int> home_of_joint_;
  std::vector<int> column_of_joint_;
  std::vector<std::vector<int>> columns_at_;  // by home + 1
};

SparseTree::SparseTree(const Skeleton& skeleton,
                       absl::Span<const EffectorTask> tasks) {
  SparseTreeBuilder(skeleton, tasks, *this).Build();
  chain_ = SerialChain::Of(Layout());
  arm_ = SerialArm::Create(Layout());
  if (chain_) {
    absl::StatusOr<BoneChain> bones =
        BoneChain::Of(skeleton, Layout(), joints_of_nodes_);
    if (bones.ok()) bones_ = *std::move(bones);
  }
}

kernel::TreeLayout SparseTree::Layout() const {
  return {nodes_.data(),
          rotation_limits_.data(),
          columns_.data(),
          lower_.data(),
          upper_.data(),
          path_columns_.data(),
          followers_.data(),
          tasks_.data(),
          frames_.data(),
          static_cast<int>(nodes_.size()),
          static_cast<int>(columns_.size()),
          axis_count_,
          static_cast<int>(tasks_.size()),
          h_size_,
          j_size_,
          position_count_,
          shaped_count_};
}

size_t SparseTree::ByteSize() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return sizeof(*this) + bytes(nodes_) + bytes(rotation_limits_) +
         bytes(columns_) + bytes(lower_) + bytes(upper_) +
         bytes(path_columns_) + bytes(followers_) + bytes(tasks_) +
         bytes(frames_) + bytes(joints_of_nodes_) + bytes(joints_of_columns_) +
         (chain_ ? chain_->ByteSize() : 0) + (arm_ ? sizeof(*arm_) : 0) +
         (bones_ ? bones_->ByteSize() : 0);
}

}  // namespace gelenk
