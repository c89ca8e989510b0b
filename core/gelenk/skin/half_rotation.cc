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
  const Quaterniond q = rotation.w() < 0
                            ? Quaterniond(Eigen::Vector4d(-rotation.coeffs()))
                            : rotation;
  const double swing_cosine = std::sqrt(q.w() * q.w() + q.x() * q.x());
  if (swing_cosine < kNoDirection) {
    // Half a turn of X: there is no twist to tell, and half is a right angle.
    return Quaterniond(1, 0, q.y(), q.z()).normalized();
  }
  const Quaterniond twist(q.w() / swing_cosine, q.x() / swing_cosine, 0, 0);
  const Quaterniond swing = q * twist.conjugate();
  const Quaterniond half_swing =
      Quaterniond(1 + swing.w(), 0, swing.y(), swing.z()).normalized();
  const Quaterniond half_twist =
      Quaterniond(1 + twist.w(), twist.x(), 0, 0).normalized();
  return half_swing * half_twist;
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
