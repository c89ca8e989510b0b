#include "gelenk/ik/column_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gelenk {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool Turns(const kernel::Node& node) {
  return node.type == kernel::NodeType::kSpherical ||
         node.type == kernel::NodeType::kFree;
}

}  // namespace

void ColumnBounds::Narrow(const IkProblem& problem,
                          const kernel::TreeLayout& tree,
                          std::optional<double> max_step,
                          const StepBounds* bounds,
                          const ConstVectorView& start,
                          kernel::Settings& settings) {
  const double most = max_step.value_or(kInfinity);
  const auto interval = [&](int velocity) -> Interval {
    if (bounds == nullptr) return {-most, most};
    return {std::max(-most, bounds->lower[velocity]),
            std::min(most, bounds->upper[velocity])};
  };
  lower_.assign(settings.lower, settings.lower + tree.column_count);
  upper_.assign(settings.upper, settings.upper + tree.column_count);
  turn_cosine_.assign(tree.node_count, -1);
  turn_sine_.assign(tree.node_count, 0);
  start_.assign(start.begin(), start.end());
  for (int n = 0; n < tree.node_count; ++n) {
    const kernel::Node& node = tree.nodes[n];
    const int offset =
        problem.skeleton().span(problem.tree().joint_of(n)).velocity_offset;
    if (node.mimics || offset < 0) continue;
    double turn = kInfinity;
    const int count = VelocityCount(
        problem.skeleton().joint(problem.tree().joint_of(n)).type);
    for (int k = 0; k < count; ++k) {
      const Interval step = interval(offset + k);
      const int column = node.axis + k;
      const int position = tree.columns[column].position;
      if (position < 0) {
        turn = std::min({turn, -step.lower, step.upper});
        continue;
      }
      lower_[column] = std::max(lower_[column], start[position] + step.lower);
      upper_[column] = std::min(upper_[column], start[position] + step.upper);
    }
    // Half a turn and more bounds nothing.
    if (!Turns(node) || turn >= M_PI) continue;
    turn_cosine_[n] = std::cos(0.5 * turn);
    turn_sine_[n] = std::sin(0.5 * turn);
  }
  settings.lower = lower_.data();
  settings.upper = upper_.data();
  settings.turn_start = start_.data();
  settings.turn_cosine = turn_cosine_.data();
  settings.turn_sine = turn_sine_.data();
}

}  // namespace gelenk
