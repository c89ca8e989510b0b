// Rows of a direction that is to turn into another one.
#ifndef GELENK_IK_GOALS_DIRECTION_ROWS_H_
#define GELENK_IK_GOALS_DIRECTION_ROWS_H_

#include <Eigen/Core>

namespace gelenk {

// The rotation that closes the angle between unit vectors, in a basis of the
// plane normal to `from`: the residual, 2 sin(angle / 2) long, falls by basis *
// w for each angular velocity w of `from` against `to`. From opposite
// directions half a turn about an axis that is nobody's principal one, so that
// a hinge that can make it will.
struct DirectionRows {
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, 3> basis;
};
DirectionRows TurnInto(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_DIRECTION_ROWS_H_
