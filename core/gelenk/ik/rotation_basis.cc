#include "gelenk/ik/rotation_basis.h"

namespace gelenk {
namespace {

// The square of a sum of unit vectors that are opposite but for rounding.
constexpr double kOpposite2 = 1e-12;

}  // namespace

Eigen::Matrix3d RotationBasis(const SwingTwist& parts,
                              const Eigen::Vector3d& axis,
                              const Eigen::Quaterniond& rotation) {
  // In the rest frame: swing axis n; the axis and its image, a and b. Swing
  // changes by n . w, twist by (a + b) . w / (1 + a . b) for a rotation
  // velocity w; the basis is dual to these two and n x (a + b).
  const Eigen::Vector3d sum = axis + rotation * axis;
  const Eigen::Vector3d across = sum.squaredNorm() > kOpposite2
                                     ? parts.swing_axis.cross(sum).normalized()
                                     : parts.swing_axis.cross(axis).eval();
  const Eigen::Quaterniond body_from_rest = rotation.conjugate();
  Eigen::Matrix3d basis;
  basis.col(0) = body_from_rest * parts.swing_axis;
  basis.col(1) = body_from_rest * across;
  basis.col(2) = axis;
  return basis;
}

}  // namespace gelenk
