// Four general 4 x 4 nets of control points, and the tri-cubic volume that the
// 64 points span: the definition that BezierVolume is a fast form of.
//
// A net that was sculpted by hand is an offset lattice on a control plane: it
// rides on the plane and is evaluated by this slow path, some 40 times slower
// than the power basis.
#ifndef GELENK_SKIN_CONTROL_NET_H_
#define GELENK_SKIN_CONTROL_NET_H_

#include <Eigen/Core>
#include <array>

#include "absl/types/span.h"
#include "gelenk/skin/bezier_volume.h"
#include "gelenk/skin/control_plane.h"

namespace gelenk {

struct ControlNet {
  // points[4 * i + j] is at s = half_extents[0] * (2 i / 3 - 1), and so is j
  // along t.
  std::array<Eigen::Vector3d, 16> points;
};

// The uniform net of `plane` over [-half_extents, half_extents].
ControlNet UniformNet(const ControlPlane& plane,
                      const Eigen::Vector2d& half_extents_m);

// The net of `plane` with `offsets` (4 * i + j; in m along plane normal, s_axis
// and t_axis) added to its points. The normal is s_axis x t_axis.
ControlNet SculptedNet(const ControlPlane& plane,
                       const Eigen::Vector2d& half_extents_m,
                       absl::Span<const Eigen::Vector3d> offsets);

// The sum over all 64 control points. `nets` has four.
Eigen::Vector3d SumOfControlPoints(absl::Span<const ControlNet> nets,
                                   const Eigen::Vector2d& half_extents_m,
                                   const VolumeCoordinates& at);

}  // namespace gelenk

#endif  // GELENK_SKIN_CONTROL_NET_H_
