// The coordinates in which the limits of a rotation are a box.
#ifndef GELENK_IK_ROTATION_BASIS_H_
#define GELENK_IK_ROTATION_BASIS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "gelenk/math/rotation.h"

namespace gelenk {

// The basis dual to (swing angle, swing direction, twist) at `rotation`, which
// is `parts` about `axis`; columns, body axes, unit. Turning about the first
// changes the swing angle only, about the second neither angle, about the third
// the twist only. Without a swing its direction is that of parts.swing_axis.
Eigen::Matrix3d RotationBasis(const SwingTwist& parts,
                              const Eigen::Vector3d& axis,
                              const Eigen::Quaterniond& rotation);

}  // namespace gelenk

#endif  // GELENK_IK_ROTATION_BASIS_H_
