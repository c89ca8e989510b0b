#include "gelenk/math/rotation.h"

#include <cmath>
#include <numbers>

namespace gelenk {
namespace {

// Below this the ratio sin(x)/x is 1 to the last digit.
constexpr double kTinyAngle = 1e-8;
// Unit vectors whose sum is shorter have no middle to speak of: rounding turns
// it by 1e-16 over that length.
constexpr double kOpposite = 1e-8;
// Sine or cosine below which an angle is 0 or a right angle.
constexpr double kNoAngle = 1e-12;

Eigen::Vector3d AnyPerpendicular(const Eigen::Vector3d& axis) {
  return axis.unitOrthogonal();
}

// Twice the rotation from `from` to the middle between the two.
Eigen::Quaterniond RotationThroughMiddle(const Eigen::Vector3d& from,
                                         const Eigen::Vector3d& to) {
  const Eigen::Vector3d middle = (from + to).normalized();
  const Eigen::Vector3d sine = from.cross(middle);
  return QuaternionXyzw(sine.x(), sine.y(), sine.z(), from.dot(middle))
      .normalized();
}

}  // namespace

bool NormalizeNearUnit(double* xyzw) {
  Eigen::Map<Eigen::Vector4d> coefficients(xyzw);
  const double norm = coefficients.norm();
  if (!(std::abs(norm - 1) <= kUnitTolerance)) return false;
  if (std::abs(norm - 1) > kUnitExact) coefficients /= norm;
  return true;
}

Eigen::Quaterniond ExpRotation(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const double half = 0.5 * angle;
  const double scale = angle < kTinyAngle ? 0.5 : std::sin(half) / angle;
  Eigen::Quaterniond q(std::cos(half), scale * rotation_vector.x(),
                       scale * rotation_vector.y(),
                       scale * rotation_vector.z());
  q.normalize();
  return q;
}

Eigen::Vector3d LogRotation(const Eigen::Quaterniond& rotation) {
  const Eigen::Vector3d v =
      rotation.w() < 0 ? Eigen::Vector3d(-rotation.vec()) : rotation.vec();
  const double w = std::abs(rotation.w());
  const double sine = v.norm();
  if (sine < kTinyAngle) return 2 * v;
  return (2 * std::atan2(sine, w) / sine) * v;
}

double AngleBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond difference = a.conjugate() * b;
  return 2 * std::atan2(difference.vec().norm(), std::abs(difference.w()));
}

Eigen::Quaterniond InHemisphereOf(const Eigen::Quaterniond& reference,
                                  const Eigen::Quaterniond& q) {
  if (reference.dot(q) >= 0) return q;
  return Eigen::Quaterniond(-q.w(), -q.x(), -q.y(), -q.z());
}

Eigen::Quaterniond ShortestRotation(const Eigen::Vector3d& from,
                                    const Eigen::Vector3d& to) {
  if ((from + to).norm() > kOpposite) return RotationThroughMiddle(from, to);
  // Half a turn, then the little that is left.
  const Eigen::Vector3d axis = AnyPerpendicular(from);
  return RotationThroughMiddle(-from, to) *
         QuaternionXyzw(axis.x(), axis.y(), axis.z(), 0);
}

SwingTwist DecomposeSwingTwist(const Eigen::Quaterniond& rotation,
                               const Eigen::Vector3d& axis) {
  SwingTwist parts;
  const double along = rotation.vec().dot(axis);
  const Eigen::Vector3d across = rotation.vec() - along * axis;
  const double swing_sine = across.norm();
  const double swing_cosine = std::hypot(along, rotation.w());
  parts.swing_rad = 2 * std::atan2(swing_sine, swing_cosine);
  if (swing_cosine < kNoAngle) {
    parts.swing_rad = std::numbers::pi;
    parts.swing_axis = across / swing_sine;
    return parts;
  }
  const double sign = rotation.w() < 0 ? -1 : 1;
  parts.twist_rad = 2 * std::atan2(sign * along, sign * rotation.w());
  if (parts.twist_rad <= -std::numbers::pi) parts.twist_rad = std::numbers::pi;
  if (swing_sine < kNoAngle) {
    parts.swing_axis = AnyPerpendicular(axis);
    return parts;
  }
  const Eigen::Quaterniond twist(Eigen::AngleAxisd(parts.twist_rad, axis));
  const Eigen::Quaterniond swing = rotation * twist.conjugate();
  parts.swing_axis = swing.vec();
  if (swing.w() < 0) parts.swing_axis = -parts.swing_axis;
  parts.swing_axis -= parts.swing_axis.dot(axis) * axis;
  parts.swing_axis.normalize();
  return parts;
}

Eigen::Quaterniond ComposeSwingTwist(const SwingTwist& parts,
                                     const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(
             Eigen::AngleAxisd(parts.swing_rad, parts.swing_axis)) *
         Eigen::Quaterniond(Eigen::AngleAxisd(parts.twist_rad, axis));
}

}  // namespace gelenk
