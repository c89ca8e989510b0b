// Three angles about three axes, and the rotation they make.
//
// A rotation is R(axes[0], a) * R(axes[1], b) * R(axes[2], c): each turn is
// about an axis that the turns before it have moved. Twelve orders reach every
// rotation: those in which neighbours differ, be the last axis the third one
// (Tait-Bryan) or the first again (proper Euler).
//
// The way back takes the angles from the quaternion without going through a
// matrix or an arc cosine, as in Bernardes and Viollet, "Quaternion to Euler
// angles conversion" (PLoS ONE, 2022); it is exact up to and through gimbal
// lock.
#ifndef GELENK_MATH_EULER_H_
#define GELENK_MATH_EULER_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

namespace gelenk {

// 0, 1, 2 for x, y, z.
using EulerAxes = std::array<int, 3>;

// True for the twelve orders that reach every rotation.
inline bool ReachesEveryRotation(const EulerAxes& axes) {
  return axes[0] != axes[1] && axes[1] != axes[2];
}

Eigen::Quaterniond RotationFromEuler(const EulerAxes& axes,
                                     const Eigen::Vector3d& angles_rad);

// Of all angles that make `rotation` those nearest to `near_rad`: turns are
// added and the other branch taken where that is closer. In gimbal lock the
// first angle stays at its near value. `axes` reach every rotation.
Eigen::Vector3d EulerFromRotation(const EulerAxes& axes,
                                  const Eigen::Quaterniond& rotation,
                                  const Eigen::Vector3d& near_rad);

}  // namespace gelenk

#endif  // GELENK_MATH_EULER_H_
