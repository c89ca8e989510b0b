#include "gelenk/skeleton/joint_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

struct TwistRange {
  double lower;
  double upper;
};

TwistRange RangeOf(const JointLimits& limits) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {limits.twist_lower_rad.value_or(-kInfinity),
          limits.twist_upper_rad.value_or(kInfinity)};
}

// By how much `twist` breaks the range, rad.
double ExcessOf(double twist, const TwistRange& range) {
  return std::max({range.lower - twist, twist - range.upper, 0.0});
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

double RotationLimitExcess(const JointLimits& limits,
                           const Eigen::Vector3d& axis,
                           const Eigen::Quaterniond& rotation) {
  if (!limits.HasRotationLimits()) return 0;
  const SwingTwist parts = DecomposeSwingTwist(rotation, axis);
  const TwistRange range = RangeOf(limits);
  double excess = 0;
  // At a swing of pi any twist fits.
  if (parts.swing_rad < std::numbers::pi) {
    excess = ExcessOf(NearestTurn(parts.twist_rad, range), range);
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
  const TwistRange range = RangeOf(limits);
  parts.twist_rad =
      std::clamp(NearestTurn(parts.twist_rad, range), range.lower, range.upper);
  if (limits.swing_cone_rad) {
    parts.swing_rad = std::min(parts.swing_rad, *limits.swing_cone_rad);
  }
  return InHemisphereOf(rotation, ComposeSwingTwist(parts, axis));
}

}  // namespace gelenk
