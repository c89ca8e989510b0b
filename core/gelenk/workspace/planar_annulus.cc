#include "gelenk/workspace/planar_annulus.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "gelenk/kinematics/forward_kinematics.h"

namespace gelenk {
namespace {

// Sine of the angle between axes that count as parallel: rounding of a few
// products of rotations.
constexpr double kParallelAxes = 1e-12;

}  // namespace

std::optional<PlanarAnnulus> ReachOf(const Skeleton& skeleton,
                                     absl::string_view end_effector_id) {
  const std::optional<EffectorFrame> effector =
      skeleton.FindEffector(end_effector_id);
  if (!effector) return std::nullopt;
  WorldTransforms frames;
  ForwardKinematics(skeleton, NeutralPositions(skeleton), frames);
  // Tip first.
  std::vector<Eigen::Vector3d> points = {
      frames[effector->joint] * effector->joint_from_effector.translation};
  std::optional<Eigen::Vector3d> normal;
  for (int i = effector->joint; i >= 0; i = skeleton.span(i).parent) {
    const Joint& joint = skeleton.joint(i);
    if (joint.type == JointType::kFixed) continue;
    const int q = skeleton.span(i).position_offset;
    if (joint.type != JointType::kRevolute || joint.mimic ||
        std::isfinite(skeleton.position_bounds().lower[q]) ||
        std::isfinite(skeleton.position_bounds().upper[q])) {
      return std::nullopt;
    }
    const Eigen::Vector3d axis = frames[i].rotation * joint.axis;
    if (normal && normal->cross(axis).norm() > kParallelAxes) {
      return std::nullopt;
    }
    if (!normal) normal = axis;
    points.push_back(frames[i].translation);
  }
  if (!normal) return std::nullopt;
  PlanarAnnulus annulus;
  annulus.world_normal = *normal;
  double longest = 0;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const Eigen::Vector3d link = points[i] - points[i + 1];
    const double length = (link - *normal * normal->dot(link)).norm();
    longest = std::max(longest, length);
    annulus.outer_radius_m += length;
  }
  annulus.inner_radius_m = std::max(0.0, 2 * longest - annulus.outer_radius_m);
  // The first axis, at the height of the tip.
  const Eigen::Vector3d& base = points.back();
  annulus.world_center = base + *normal * normal->dot(points.front() - base);
  return annulus;
}

}  // namespace gelenk
