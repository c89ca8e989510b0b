// Eigen's view of kernel::GoalRows, for the kinds that fill it.
#ifndef GELENK_IK_GOALS_FRAME_ROWS_H_
#define GELENK_IK_GOALS_FRAME_ROWS_H_

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "gelenk/ik/kernel/goal_rows.h"

namespace gelenk {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Row3 = Eigen::Matrix<double, 1, 3>;

inline Eigen::Map<const RowMajor3> View(const kernel::Matrix3& m) {
  return Eigen::Map<const RowMajor3>(m);
}
inline Eigen::Map<const Eigen::Vector3d> View(const kernel::Vector3& v) {
  return Eigen::Map<const Eigen::Vector3d>(v);
}
inline void Store(const Eigen::Matrix3d& from, kernel::Matrix3& to) {
  Eigen::Map<RowMajor3> view(to);
  view = from;
}
inline void Store(const Eigen::Vector3d& from, kernel::Vector3& to) {
  Eigen::Map<Eigen::Vector3d> view(to);
  view = from;
}

// The part of row `r` that goes with a frame's velocity, and with its angular
// velocity.
inline Eigen::Map<Row3> VelocityRow(kernel::GoalRows& rows, int frame, int r) {
  return Eigen::Map<Row3>(rows.rows[frame][r]);
}
inline Eigen::Map<Row3> AngularRow(kernel::GoalRows& rows, int frame, int r) {
  return Eigen::Map<Row3>(rows.rows[frame][r] + 3);
}

// Whose gradient an angle's rows are: 4 (1 - cos(angle / 2)), by the square of
// 2 sin(angle / 2).
inline double AngleEnergy(double error2) {
  return error2 / (1 + std::sqrt(std::max(0.0, 1 - 0.25 * error2)));
}

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_FRAME_ROWS_H_
