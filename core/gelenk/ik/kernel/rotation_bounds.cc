#include "gelenk/ik/kernel/rotation_bounds.h"

#include <cmath>
#include <numbers>

#include "gelenk/ik/rotation_basis.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/joint_limits.h"

namespace gelenk::kernel {
namespace {

// Clamping leaves a rotation on its bound to about this, rad.
constexpr double kOnBound = 1e-9;
// A cone this small allows no swing.
constexpr double kPointCone = 1e-6;

JointLimits LimitsOf(const RotationLimit& limit) {
  JointLimits limits;
  if (std::isfinite(limit.swing_cone)) limits.swing_cone_rad = limit.swing_cone;
  if (std::isfinite(limit.twist_lower)) {
    limits.twist_lower_rad = limit.twist_lower;
  }
  if (std::isfinite(limit.twist_upper)) {
    limits.twist_upper_rad = limit.twist_upper;
  }
  return limits;
}

// True when twist `angle`, at any turn, lies on `bound`.
bool OnTwistBound(double angle, double bound) {
  return std::isfinite(bound) &&
         std::abs(std::remainder(angle - bound, 2 * std::numbers::pi)) <=
             kOnBound;
}

}  // namespace

uint8_t TouchRotationLimit(const RotationLimit& limit, const double* rotation,
                           double* body_basis) {
  const Eigen::Vector3d axis(limit.axis[0], limit.axis[1], limit.axis[2]);
  const Eigen::Quaterniond q = QuaternionXyzw(rotation);
  const SwingTwist parts = DecomposeSwingTwist(q, axis);
  uint8_t touched = 0;
  if (parts.swing_rad >= limit.swing_cone - kOnBound) touched |= kTouchesCone;
  if (OnTwistBound(parts.twist_rad, limit.twist_lower)) {
    touched |= kTouchesTwistLower;
  }
  if (OnTwistBound(parts.twist_rad, limit.twist_upper)) {
    touched |= kTouchesTwistUpper;
  }
  if (touched == 0) return 0;
  if (limit.swing_cone <= kPointCone) touched |= kConeIsPoint;

  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> basis(body_basis);
  basis = RotationBasis(parts, axis, q);
  return touched;
}

void ClampToRotationLimit(const RotationLimit& limit, double* rotation) {
  const Eigen::Vector3d axis(limit.axis[0], limit.axis[1], limit.axis[2]);
  StoreXyzw(ClampRotation(LimitsOf(limit), axis, QuaternionXyzw(rotation)),
            rotation);
}

}  // namespace gelenk::kernel
