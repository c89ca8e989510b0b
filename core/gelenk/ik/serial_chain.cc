#include "gelenk/ik/serial_chain.h"

#include <algorithm>

namespace gelenk {
namespace {

using kernel::ChainStep;
using kernel::kChainLanes;
using kernel::Node;
using kernel::NodeType;

bool IsSerialChain(const kernel::TreeLayout& tree) {
  if (tree.task_count != 1 || tree.node_count == 0) return false;
  const kernel::Task& task = tree.tasks[0];
  if (task.shape != kernel::GoalShape::kPose) return false;
  if (task.row_begin != 0 || task.row_end != 3) return false;
  return std::all_of(tree.nodes, tree.nodes + tree.node_count,
                     [](const Node& node) {
                       return !node.mimics && node.type != NodeType::kPlanar &&
                              node.type != NodeType::kFree;
                     });
}

// A step in which every lane idles.
ChainStep IdleStep(NodeType type) {
  ChainStep step = {};
  for (int lane = 0; lane < kChainLanes; ++lane) {
    for (int k = 0; k < 3; ++k) step.rotation[4 * k][lane] = 1;
    step.node[lane] = -1;
  }
  step.type = type;
  step.offset_is_translation = true;
  return step;
}

void Place(const kernel::TreeLayout& tree, int n, int lane, ChainStep& step) {
  const Node& node = tree.nodes[n];
  for (int k = 0; k < 9; ++k) {
    step.rotation[k][lane] = node.parent_from_rest_rotation[k];
  }
  for (int k = 0; k < 3; ++k) {
    step.translation[k][lane] = node.parent_from_rest_translation[k];
  }
  const int columns = node.type == NodeType::kSpherical ? 3 : 1;
  for (int k = 0; k < columns; ++k) {
    step.compliance[k][lane] = 1 / tree.columns[node.axis + k].stiffness;
  }
  step.node[lane] = n;
  step.column[lane] = node.axis;
  step.position[lane] = node.position;
  step.limited[lane] = node.limits_rotation;
  step.limits_rotation = step.limits_rotation || node.limits_rotation;
  step.offset_is_translation =
      step.offset_is_translation && node.offset_is_translation;
}

}  // namespace

std::optional<SerialChain> SerialChain::Of(const kernel::TreeLayout& tree) {
  if (!IsSerialChain(tree)) return std::nullopt;
  return SerialChain(tree);
}

SerialChain::SerialChain(const kernel::TreeLayout& tree) {
  // Segments of as many nodes each as it takes.
  const int length = (tree.node_count + kChainLanes - 1) / kChainLanes;
  layout_.lane_count = (tree.node_count + length - 1) / length;
  int next[kChainLanes];
  int end[kChainLanes];
  for (int lane = 0; lane < kChainLanes; ++lane) {
    next[lane] = std::min(lane * length, tree.node_count);
    end[lane] = std::min((lane + 1) * length, tree.node_count);
  }
  // Each step serves the type that the first unfinished segment wants.
  for (;;) {
    const auto unfinished = [&] {
      for (int lane = 0; lane < kChainLanes; ++lane) {
        if (next[lane] < end[lane]) return lane;
      }
      return -1;
    };
    const int first = unfinished();
    if (first < 0) break;
    const NodeType type = tree.nodes[next[first]].type;
    ChainStep step = IdleStep(type);
    for (int lane = 0; lane < kChainLanes; ++lane) {
      if (next[lane] == end[lane] || tree.nodes[next[lane]].type != type) {
        continue;
      }
      Place(tree, next[lane]++, lane, step);
    }
    has_spherical_ = has_spherical_ || type == NodeType::kSpherical;
    step.record = layout_.record_size;
    layout_.record_size += type == NodeType::kSpherical
                               ? kernel::kSphericalRecord
                               : kernel::kScalarRecord;
    steps_.push_back(step);
  }
  steps_.shrink_to_fit();
  layout_.step_count = static_cast<int>(steps_.size());
  layout_.rotation_limits = tree.rotation_limits;
  for (int k = 0; k < 3; ++k) {
    layout_.last_from_tip[k] = tree.tasks[0].node_from_effector_translation[k];
  }
}

kernel::ChainLayout SerialChain::Layout() const {
  kernel::ChainLayout layout = layout_;
  layout.steps = steps_.data();
  return layout;
}

}  // namespace gelenk
