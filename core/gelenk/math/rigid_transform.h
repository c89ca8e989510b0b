// A rigid motion of space: rotate first, then translate.
//
// Named `a_from_b`: it maps coordinates in frame b to coordinates in frame a,
// so that `a_from_c = a_from_b * b_from_c`.
#ifndef GELENK_MATH_RIGID_TRANSFORM_H_
#define GELENK_MATH_RIGID_TRANSFORM_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace gelenk {

struct RigidTransform {
  // Unit.
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  // m.
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  RigidTransform operator*(const RigidTransform& other) const {
    return {rotation * other.rotation,
            rotation * other.translation + translation};
  }

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return rotation * point + translation;
  }

  RigidTransform Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, inverse * -translation};
  }
};

}  // namespace gelenk

#endif  // GELENK_MATH_RIGID_TRANSFORM_H_
