#include "gelenk/ik/step_bounds.h"

#include <algorithm>
#include <limits>

namespace gelenk {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double LimitOf(const std::vector<double>& limits, int index) {
  return limits.empty() ? kInfinity : limits[index];
}

}  // namespace

void SpeedLimits(const Skeleton& skeleton, absl::Duration interval,
                 const ConstVectorView& velocity, StepBounds& bounds) {
  const double dt_s = std::max(0.0, absl::ToDoubleSeconds(interval));
  bounds.lower.setConstant(skeleton.velocity_count(), -kInfinity);
  bounds.upper.setConstant(skeleton.velocity_count(), kInfinity);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int offset = skeleton.span(j).velocity_offset;
    if (offset < 0) continue;
    const JointLimits& limits = skeleton.joint(j).limits;
    const int count = VelocityCount(skeleton.joint(j).type);
    for (int k = 0; k < count; ++k) {
      const double fastest = LimitOf(limits.max_velocity, k);
      const double change = LimitOf(limits.max_acceleration, k) * dt_s;
      double lower = -fastest;
      double upper = fastest;
      if (change < kInfinity) {
        lower = std::max(lower, velocity[offset + k] - change);
        upper = std::min(upper, velocity[offset + k] + change);
      }
      // Standing still is never forbidden: a target or a limit may ask for it.
      bounds.lower[offset + k] =
          lower == -kInfinity ? lower : std::min(lower, 0.0) * dt_s;
      bounds.upper[offset + k] =
          upper == kInfinity ? upper : std::max(upper, 0.0) * dt_s;
    }
  }
}

bool HasSpeedLimits(const Skeleton& skeleton) {
  return std::any_of(skeleton.joints().begin(), skeleton.joints().end(),
                     [](const Joint& joint) {
                       return !joint.limits.max_velocity.empty() ||
                              !joint.limits.max_acceleration.empty();
                     });
}

}  // namespace gelenk
