// The exact reach of a chain of revolute joints with parallel axes and no
// limits: the ring between two circles.
#ifndef GELENK_WORKSPACE_PLANAR_ANNULUS_H_
#define GELENK_WORKSPACE_PLANAR_ANNULUS_H_

#include <Eigen/Core>
#include <optional>

#include "absl/strings/string_view.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct PlanarAnnulus {
  Eigen::Vector3d world_center = Eigen::Vector3d::Zero();
  // Unit; the ring lies in the plane across it through the center.
  Eigen::Vector3d world_normal = Eigen::Vector3d::UnitZ();
  // The longest link minus all others, at least 0; and all links together.
  double inner_radius_m = 0;
  double outer_radius_m = 0;
};

// None when there is no such effector, or a joint on the way to it is neither
// fixed nor revolute, mimics, has limits, or is not parallel to the others.
std::optional<PlanarAnnulus> ReachOf(const Skeleton& skeleton,
                                     absl::string_view end_effector_id);

}  // namespace gelenk

#endif  // GELENK_WORKSPACE_PLANAR_ANNULUS_H_
