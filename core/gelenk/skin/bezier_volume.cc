#include "gelenk/skin/bezier_volume.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace gelenk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// c' . (a x b) has degree 2 + 3 + 3: five nodes of Gauss are exact.
constexpr int kNodes = 5;
constexpr double kNode[kNodes] = {0, 0.5384693101056831, -0.5384693101056831,
                                  0.9061798459386640, -0.9061798459386640};
constexpr double kNodeWeight[kNodes] = {0.5688888888888889, 0.4786286704993665,
                                        0.4786286704993665, 0.2369268850561891,
                                        0.2369268850561891};

// Bisection alone halves [0, 1] to the last digit in 53 steps.
constexpr int kMaxInversionSteps = 60;
constexpr double kParameterTolerance = 1e-15;
// How far, as a fraction of u, a point may lie beyond an end plane and still
// count as on it: rounding of a point that was computed on the plane.
constexpr double kEndTolerance = 1e-12;
// Below this a coefficient is rounding of a straight, uniform volume.
constexpr double kAffineTolerance = 1e-14;
constexpr int kFoldSamples = 33;

double Determinant(const Vector3d& u, const ControlPlane& plane) {
  return u.dot(plane.s_axis().cross(plane.t_axis()));
}

// Distance of the point from the plane times the plane's area element, and its
// derivative by u.
struct PlaneDistance {
  double value;
  double derivative;
  double area;  // |a x b|
};

PlaneDistance DistanceAt(const BezierVolume& volume, double u,
                         const Vector3d& point) {
  const ControlPlane plane = volume.At(u);
  const ControlPlane slope = volume.DerivativeAt(u);
  const Vector3d normal = plane.s_axis().cross(plane.t_axis());
  const Vector3d offset = point - plane.center();
  const Vector3d turn = slope.s_axis().cross(plane.t_axis()) +
                        plane.s_axis().cross(slope.t_axis());
  return {offset.dot(normal), offset.dot(turn) - slope.center().dot(normal),
          normal.norm()};
}

// s and t of a point that lies in the section at u.
VolumeCoordinates InSection(const BezierVolume& volume, double u,
                            const Vector3d& point) {
  const ControlPlane plane = volume.At(u);
  const Vector3d normal = plane.s_axis().cross(plane.t_axis());
  const Vector3d offset = point - plane.center();
  const double area2 = normal.squaredNorm();
  return {u, offset.cross(plane.t_axis()).dot(normal) / area2,
          plane.s_axis().cross(offset).dot(normal) / area2};
}

}  // namespace

Matrix3d VolumePoint::Jacobian() const {
  Matrix3d jacobian;
  jacobian << along_u, along_s, along_t;
  return jacobian;
}

BezierVolume::BezierVolume() { coefficients_.fill(Matrix3d::Zero()); }

BezierVolume BezierVolume::Between(absl::Span<const ControlPlane> planes) {
  const Matrix3d& p0 = planes[0].columns;
  const Matrix3d& p1 = planes[1].columns;
  const Matrix3d& p2 = planes[2].columns;
  const Matrix3d& p3 = planes[3].columns;
  BezierVolume volume;
  volume.coefficients_[0] = p0;
  volume.coefficients_[1] = 3 * (p1 - p0);
  volume.coefficients_[2] = 3 * ((p0 - p1) + (p2 - p1));
  volume.coefficients_[3] = (p3 - p0) + 3 * (p1 - p2);
  return volume;
}

BezierVolume BezierVolume::Affine(const ControlPlane& start,
                                  const ControlPlane& growth) {
  BezierVolume volume;
  volume.coefficients_[0] = start.columns;
  volume.coefficients_[1] = growth.columns;
  return volume;
}

ControlPlane BezierVolume::At(double u) const {
  return ControlPlane(
      coefficients_[0] +
      u * (coefficients_[1] + u * (coefficients_[2] + u * coefficients_[3])));
}

ControlPlane BezierVolume::DerivativeAt(double u) const {
  return ControlPlane(coefficients_[1] +
                      u * (2 * coefficients_[2] + 3 * u * coefficients_[3]));
}

VolumePoint BezierVolume::Evaluate(const VolumeCoordinates& at) const {
  const ControlPlane plane = At(at.u);
  return {plane(at.s, at.t), DerivativeAt(at.u)(at.s, at.t), plane.s_axis(),
          plane.t_axis()};
}

bool BezierVolume::IsAffine() const {
  const double size = coefficients_[1].col(0).norm() * kAffineTolerance;
  return coefficients_[2].cwiseAbs().maxCoeff() <= size &&
         coefficients_[3].cwiseAbs().maxCoeff() <= size &&
         coefficients_[1].rightCols<2>().cwiseAbs().maxCoeff() <=
             kAffineTolerance;
}

std::optional<VolumeCoordinates> BezierVolume::Invert(
    const Vector3d& point) const {
  if (IsAffine()) {
    Matrix3d jacobian;
    jacobian << coefficients_[1].col(0), coefficients_[0].rightCols<2>();
    const Vector3d at = jacobian.inverse() * (point - coefficients_[0].col(0));
    if (!(at[0] >= -kEndTolerance && at[0] <= 1 + kEndTolerance)) {
      return std::nullopt;
    }
    return VolumeCoordinates{at[0], at[1], at[2]};
  }
  const PlaneDistance start = DistanceAt(*this, 0, point);
  const PlaneDistance end = DistanceAt(*this, 1, point);
  const double length = (At(1).center() - At(0).center()).norm();
  if (std::abs(start.value) <= kEndTolerance * start.area * length) {
    return InSection(*this, 0, point);
  }
  if (std::abs(end.value) <= kEndTolerance * end.area * length) {
    return InSection(*this, 1, point);
  }
  if (!(start.value > 0 && end.value < 0)) return std::nullopt;
  double low = 0;
  double high = 1;
  double u = start.value / (start.value - end.value);
  for (int step = 0; step < kMaxInversionSteps; ++step) {
    const PlaneDistance g = DistanceAt(*this, u, point);
    (g.value > 0 ? low : high) = u;
    double next = u - g.value / g.derivative;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double change = std::abs(next - u);
    u = next;
    if (change <= kParameterTolerance) break;
  }
  return InSection(*this, u, point);
}

double BezierVolume::VolumePerSection() const {
  double volume = 0;
  for (int i = 0; i < kNodes; ++i) {
    const double u = 0.5 * (1 + kNode[i]);
    volume +=
        0.5 * kNodeWeight[i] * Determinant(DerivativeAt(u).center(), At(u));
  }
  return volume;
}

double BezierVolume::LeastJacobian(
    const Eigen::Vector2d& half_extents_m) const {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kFoldSamples; ++i) {
    const double u = i / (kFoldSamples - 1.0);
    const ControlPlane plane = At(u);
    const ControlPlane slope = DerivativeAt(u);
    // det = alpha + beta s + gamma t, least on the border of the ellipse.
    const Vector3d normal = plane.s_axis().cross(plane.t_axis());
    const double beta = slope.s_axis().dot(normal) * half_extents_m[0];
    const double gamma = slope.t_axis().dot(normal) * half_extents_m[1];
    least = std::min(least, slope.center().dot(normal) -
                                std::sqrt(beta * beta + gamma * gamma));
  }
  return least;
}

Vector3d DeformedNormal(const VolumePoint& deformed,
                        const Vector3d& rest_components) {
  return rest_components[0] * deformed.along_s.cross(deformed.along_t) +
         deformed.along_u.cross(rest_components[2] * deformed.along_s -
                                rest_components[1] * deformed.along_t);
}

}  // namespace gelenk
