#include "gelenk/ik/goals/direction_rows.h"

#include <Eigen/Geometry>
#include <cmath>

namespace gelenk {
namespace {

// Of 1 + cos(angle): below, the axis of half a turn is noise.
constexpr double kOpposite = 1e-14;

// Smooth near `v`, also where that is an axis of the world.
Eigen::Vector3d Across(const Eigen::Vector3d& v) {
  int largest;
  v.cwiseAbs().maxCoeff(&largest);
  return v.cross(Eigen::Vector3d::Unit((largest + 1) % 3)).normalized();
}

}  // namespace

DirectionRows TurnInto(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  DirectionRows rows;
  const Eigen::Vector3d u = Across(from);
  rows.basis.row(0) = u;
  rows.basis.row(1) = from.cross(u);
  const double half_cosine2 = 0.5 * (1 + from.dot(to));
  if (half_cosine2 < kOpposite) {
    rows.residual = 2 * Eigen::Vector2d(std::cos(1.0), std::sin(1.0));
    return rows;
  }
  // |from x to| = 2 sin(angle / 2) cos(angle / 2).
  const Eigen::Vector3d across = from.cross(to) / std::sqrt(half_cosine2);
  rows.residual = rows.basis * across;
  return rows;
}

}  // namespace gelenk
