// A control plane: 4 x 4 control points that move as one affine unit.
//
// The lattice of the points is uniform, so the bicubic patch that they control
// is the affine map P(s, t) = center + s * s_axis + t * t_axis itself; s and t
// are metres across the link at rest. A plane that is no such lattice is a
// ControlNet.
#ifndef GELENK_SKIN_CONTROL_PLANE_H_
#define GELENK_SKIN_CONTROL_PLANE_H_

#include <Eigen/Core>

namespace gelenk {

struct ControlPlane {
  using Column = Eigen::Matrix3d::ConstColXpr;

  // center, s_axis, t_axis. One matrix, so that planes add like numbers.
  Eigen::Matrix3d columns = Eigen::Matrix3d::Zero();

  ControlPlane() = default;
  explicit ControlPlane(const Eigen::Matrix3d& center_and_axes)
      : columns(center_and_axes) {}
  ControlPlane(const Eigen::Vector3d& center, const Eigen::Vector3d& s_axis,
               const Eigen::Vector3d& t_axis) {
    columns << center, s_axis, t_axis;
  }

  Column center() const { return columns.col(0); }
  Column s_axis() const { return columns.col(1); }
  Column t_axis() const { return columns.col(2); }

  Eigen::Vector3d operator()(double s, double t) const {
    return center() + s * s_axis() + t * t_axis();
  }
};

inline ControlPlane Middle(const ControlPlane& a, const ControlPlane& b) {
  return ControlPlane(0.5 * (a.columns + b.columns));
}

}  // namespace gelenk

#endif  // GELENK_SKIN_CONTROL_PLANE_H_
