#include "gelenk/skin/half_rotation.h"

#include <cmath>

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// Below this length a half has no direction.
constexpr double kNoDirection = 1e-9;
// Rest rotations with a smaller vector part are none.
constexpr double kNoRotation = 1e-12;

}  // namespace

Quaterniond HalfSwingAndTwist(const Quaterniond& rotation) {
  const double sign = rotation.w() < 0 ? -1 : 1;
  const double w = sign * rotation.w(), x = sign * rotation.x();
  const double y = sign * rotation.y(), z = sign * rotation.z();
  // The twist is (w, x, 0, 0) / n, the swing n + what is across X; the half of
  // a unit quaternion q is 1 + q, normalised.
  const double n = std::sqrt(w * w + x * x);
  if (n < kNoDirection) {
    // Half a turn of X: there is no twist to tell, and half is a right angle.
    return Quaterniond(1, 0, y, z).normalized();
  }
  const double swing_norm = std::sqrt(2 * (1 + n));
  const double swing_w = 0.5 * swing_norm;
  const double swing_scale = 1 / (n * swing_norm);
  const double swing_y = (y * w - z * x) * swing_scale;
  const double swing_z = (z * w + y * x) * swing_scale;
  const double twist_scale = 1 / std::sqrt(2 * n * (n + w));
  const double twist_w = (n + w) * twist_scale;
  const double twist_x = x * twist_scale;
  return Quaterniond(swing_w * twist_w, swing_w * twist_x,
                     swing_y * twist_w + swing_z * twist_x,
                     swing_z * twist_w - swing_y * twist_x);
}

Quaterniond HalfHinge(const Quaterniond& rest, const Vector3d& axis,
                      double angle_rad) {
  if (rest.vec().norm() < kNoRotation) {
    return Quaterniond(Eigen::AngleAxisd(0.5 * angle_rad, axis));
  }
  // The sign of a quaternion counts one turn: keep it.
  const Quaterniond turn(std::cos(0.5 * angle_rad),
                         std::sin(0.5 * angle_rad) * axis.x(),
                         std::sin(0.5 * angle_rad) * axis.y(),
                         std::sin(0.5 * angle_rad) * axis.z());
  Quaterniond half = InHemisphereOf(Quaterniond::Identity(), rest) * turn;
  half.w() += 1;
  const double norm = half.norm();
  if (norm < kNoDirection)
    return QuaternionXyzw(axis.x(), axis.y(), axis.z(), 0);
  half.coeffs() /= norm;
  return half;
}

}  // namespace gelenk
