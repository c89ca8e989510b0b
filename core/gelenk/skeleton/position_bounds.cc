#include "gelenk/skeleton/position_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gelenk/base/number_check.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {
namespace {

// What no position gets to is no limit.
double AsBound(double limit) {
  return IsUsable(limit) ? limit : std::copysign(HUGE_VAL, limit);
}

void SetOwnLimits(const Joint& joint, int offset, PositionBounds& bounds) {
  for (size_t k = 0; k < joint.limits.lower.size(); ++k) {
    bounds.lower[offset + k] = AsBound(joint.limits.lower[k]);
    bounds.upper[offset + k] = AsBound(joint.limits.upper[k]);
  }
}

// Narrows the bounds at `offset`, of the joint that `follower` mimics.
void FoldMimicLimits(const Joint& follower, int offset,
                     PositionBounds& bounds) {
  const Mimic& mimic = *follower.mimic;
  if (follower.limits.lower.empty() || mimic.multiplier == 0) return;
  double lower = (follower.limits.lower[0] - mimic.offset) / mimic.multiplier;
  double upper = (follower.limits.upper[0] - mimic.offset) / mimic.multiplier;
  if (lower > upper) std::swap(lower, upper);
  lower = std::max(AsBound(lower), bounds.lower[offset]);
  upper = std::min(AsBound(upper), bounds.upper[offset]);
  // Also false where they leave nothing but what no position gets to.
  if (!(lower <= upper && lower <= kLargestNumber &&
        upper >= -kLargestNumber)) {
    return;
  }
  bounds.lower[offset] = lower;
  bounds.upper[offset] = upper;
}

}  // namespace

PositionBounds BoundPositions(absl::Span<const Joint> joints,
                              absl::Span<const JointSpan> spans,
                              int position_count) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  PositionBounds bounds = {
      Eigen::VectorXd::Constant(position_count, -kInfinity),
      Eigen::VectorXd::Constant(position_count, kInfinity)};
  for (size_t i = 0; i < joints.size(); ++i) {
    if (spans[i].position_offset < 0) continue;
    SetOwnLimits(joints[i], spans[i].position_offset, bounds);
  }
  for (size_t i = 0; i < joints.size(); ++i) {
    if (spans[i].mimicked < 0) continue;
    FoldMimicLimits(joints[i], spans[spans[i].mimicked].position_offset,
                    bounds);
  }
  return bounds;
}

}  // namespace gelenk
