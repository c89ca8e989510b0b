#include "gelenk/skin/control_net.h"

#include <Eigen/Geometry>

namespace gelenk {
namespace {

constexpr int kSide = 4;

std::array<double, 4> Bernstein(double x) {
  const double y = 1 - x;
  return {y * y * y, 3 * x * y * y, 3 * x * x * y, x * x * x};
}

}  // namespace

ControlNet UniformNet(const ControlPlane& plane,
                      const Eigen::Vector2d& half_extents_m) {
  ControlNet net;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      net.points[kSide * i + j] = plane(half_extents_m[0] * (2 * i / 3.0 - 1),
                                        half_extents_m[1] * (2 * j / 3.0 - 1));
    }
  }
  return net;
}

ControlNet SculptedNet(const ControlPlane& plane,
                       const Eigen::Vector2d& half_extents_m,
                       absl::Span<const Eigen::Vector3d> offsets) {
  ControlNet net = UniformNet(plane, half_extents_m);
  const Eigen::Vector3d normal = plane.s_axis().cross(plane.t_axis());
  for (size_t i = 0; i < net.points.size(); ++i) {
    net.points[i] += offsets[i][0] * normal + offsets[i][1] * plane.s_axis() +
                     offsets[i][2] * plane.t_axis();
  }
  return net;
}

Eigen::Vector3d SumOfControlPoints(absl::Span<const ControlNet> nets,
                                   const Eigen::Vector2d& half_extents_m,
                                   const VolumeCoordinates& at) {
  const std::array<double, 4> along = Bernstein(at.u);
  const std::array<double, 4> across_s =
      Bernstein(0.5 * (at.s / half_extents_m[0] + 1));
  const std::array<double, 4> across_t =
      Bernstein(0.5 * (at.t / half_extents_m[1] + 1));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < kSide; ++k) {
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) {
        sum += along[k] * across_s[i] * across_t[j] *
               nets[k].points[kSide * i + j];
      }
    }
  }
  return sum;
}

}  // namespace gelenk
