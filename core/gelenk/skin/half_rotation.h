// Half of the rotation of a joint: how far its control planes turn.
//
// The planes on either side of a joint lie in the bisector of its links.
// Halving a quaternion flips at half a turn; these do not, as far as what they
// are given can tell.
#ifndef GELENK_SKIN_HALF_ROTATION_H_
#define GELENK_SKIN_HALF_ROTATION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace gelenk {

// For joints that can turn any way: half of the swing of X, then half of the
// twist about it. Flips where the swing passes half a turn or the twist passes
// half a turn: a rotation does not count turns.
Eigen::Quaterniond HalfSwingAndTwist(const Eigen::Quaterniond& rotation);

// For hinges: half of `rest` * (turn by `angle_rad` about the unit `axis`), by
// the joint's own angle, so that it is continuous for a whole turn either way;
// without `rest` it is the turn by half of the angle, for any.
Eigen::Quaterniond HalfHinge(const Eigen::Quaterniond& rest,
                             const Eigen::Vector3d& axis, double angle_rad);

}  // namespace gelenk

#endif  // GELENK_SKIN_HALF_ROTATION_H_
