// A tri-cubic Bezier volume between four control planes: half of a link.
//
// Because its planes are affine, the volume is
//   F(u, s, t) = c(u) + s a(u) + t b(u),   u in [0, 1],
// with c, a, b cubic in u: 36 numbers in the power basis. At a fixed u the
// image is a plane section. World frame, m.
//
// Source: Sederberg and Parry, "Free-form deformation of solid geometric
// models", 1986; Chadwick, Haumann, Parent, "Layered construction for
// deformable animated characters", 1989.
#ifndef GELENK_SKIN_BEZIER_VOLUME_H_
#define GELENK_SKIN_BEZIER_VOLUME_H_

#include <Eigen/Core>
#include <array>
#include <optional>

#include "absl/types/span.h"
#include "gelenk/skin/control_plane.h"

namespace gelenk {

// Where a point lies in a volume: u along it, s and t (m) across.
struct VolumeCoordinates {
  double u = 0;
  double s = 0;
  double t = 0;
};

// A point of a volume and the derivatives of F there.
struct VolumePoint {
  Eigen::Vector3d position;
  Eigen::Vector3d along_u;
  Eigen::Vector3d along_s;
  Eigen::Vector3d along_t;

  // Columns u, s, t.
  Eigen::Matrix3d Jacobian() const;
};

class BezierVolume {
 public:
  // All zero.
  BezierVolume();

  // The cubic between `planes` (four of them).
  static BezierVolume Between(absl::Span<const ControlPlane> planes);

  // The affine volume start + u * growth.
  static BezierVolume Affine(const ControlPlane& start,
                             const ControlPlane& growth);

  // F = sum of coefficient(k) u^k; each is a plane (c, a, b).
  const Eigen::Matrix3d& coefficient(int k) const { return coefficients_[k]; }

  ControlPlane At(double u) const;
  // Of c, a and b by u.
  ControlPlane DerivativeAt(double u) const;

  Eigen::Vector3d Position(const VolumeCoordinates& at) const {
    return At(at.u)(at.s, at.t);
  }
  VolumePoint Evaluate(const VolumeCoordinates& at) const;

  // The coordinates of `point` with u in [0, 1]: a root of
  // g(u) = (point - c(u)) . (a(u) x b(u)). Nothing when the end planes do not
  // have the point between them. Closed form where the volume is a straight,
  // uniform one, else Newton guarded by bisection; about 8 steps.
  std::optional<VolumeCoordinates> Invert(const Eigen::Vector3d& point) const;

  // Volume, m^3, per m^2 of a section that is centred in s and t: the integral
  // of c' . (a x b), exact.
  double VolumePerSection() const;

  // The least det(F_u, F_s, F_t) over the elliptic section with half axes
  // `half_extents_m` (s, t), at 33 u: negative where the volume folds over.
  double LeastJacobian(const Eigen::Vector2d& half_extents_m) const;

 private:
  bool IsAffine() const;

  std::array<Eigen::Matrix3d, 4> coefficients_;
};

// The normal of the deformed surface, not normalised, from `rest_components`:
// the normal n at rest as (n . F_u, n . F_s, n . F_t) of the rest volume.
Eigen::Vector3d DeformedNormal(const VolumePoint& deformed,
                               const Eigen::Vector3d& rest_components);

}  // namespace gelenk

#endif  // GELENK_SKIN_BEZIER_VOLUME_H_
