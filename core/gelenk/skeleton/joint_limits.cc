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

// The turn of `twist` that breaks the range least.
double NearestTurn(double twist, const TwistRange& range) {
  const auto excess = [&range](double t) {
    return std::max({range.lower - t, t - range.upper, 0.0});
  };
  double best = twist;
  for (double candidate : {twist - kTurn, twist + kTurn}) {
    if (excess(candidate) < excess(best)) best = candidate;
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
  const double twist = NearestTurn(parts.twist_rad, range);
  double excess = std::max({range.lower - twist, twist - range.upper, 0.0});
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
