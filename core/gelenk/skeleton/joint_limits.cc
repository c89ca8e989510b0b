#include "gelenk/skeleton/joint_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
// A range that falls short of a turn by less than this is one, written in
// decimals.
constexpr double kWholeTurn = 1e-6;

// By how much `twist` breaks the range, rad.
double ExcessOf(double twist, const TwistRange& range) {
  return std::max({range.lower_rad - twist, twist - range.upper_rad, 0.0});
}

// The turn of `twist` that breaks the range least.
double NearestTurn(double twist, const TwistRange& range) {
  double best = twist;
  for (double candidate : {twist - kTurn, twist + kTurn}) {
    if (ExcessOf(candidate, range) < ExcessOf(best, range)) best = candidate;
  }
  return best;
}

}  // namespace

std::optional<TwistRange> TwistRangeOf(const JointLimits& limits) {
  if (!limits.twist_lower_rad && !limits.twist_upper_rad) return std::nullopt;
  const TwistRange range = {limits.twist_lower_rad.value_or(-std::numbers::pi),
                            limits.twist_upper_rad.value_or(std::numbers::pi)};
  if (range.upper_rad - range.lower_rad >= kTurn - kWholeTurn) {
    return std::nullopt;
  }
  return range;
}

double RotationLimitExcess(const JointLimits& limits,
                           const Eigen::Vector3d& axis,
                           const Eigen::Quaterniond& rotation) {
  if (!limits.HasRotationLimits()) return 0;
  const SwingTwist parts = DecomposeSwingTwist(rotation, axis);
  const std::optional<TwistRange> range = TwistRangeOf(limits);
  double excess = 0;
  // At a swing of pi any twist fits.
  if (range && parts.swing_rad < std::numbers::pi) {
    excess = ExcessOf(NearestTurn(parts.twist_rad, *range), *range);
  }
  if (limits.swing_cone_rad) {
    excess = std::max(excess, parts.swing_rad - *limits.swing_cone_rad);
  }
  return excess;
}

Eigen::Quaterniond ClampRotation(const JointLimits& limits,
                                 const Eigen::Vector3d& axis,
                                 const Eigen::Quaterniond& rotation) {
  if (RotationLimitExcess(limits, axis, rotation) <= 0) return rotation;
  SwingTwist parts = DecomposeSwingTwist(rotation, axis);
  if (const std::optional<TwistRange> range = TwistRangeOf(limits)) {
    parts.twist_rad = std::clamp(NearestTurn(parts.twist_rad, *range),
                                 range->lower_rad, range->upper_rad);
  }
  if (limits.swing_cone_rad) {
    parts.swing_rad = std::min(parts.swing_rad, *limits.swing_cone_rad);
  }
  return InHemisphereOf(rotation, ComposeSwingTwist(parts, axis));
}

}  // namespace gelenk
