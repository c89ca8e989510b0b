// Damped least squares as it is found in many places, for comparison: a fixed
// number of steps a frame, a fixed damping, and limits by clamping afterwards.
#ifndef GELENK_TESTS_BENCHMARKS_IK_DAMPED_LEAST_SQUARES_H_
#define GELENK_TESTS_BENCHMARKS_IK_DAMPED_LEAST_SQUARES_H_

#include <Eigen/Core>
#include <string>

#include "gelenk/skeleton/pose.h"

namespace gelenk::benchmarks {

struct DampedLeastSquares {
  // m per rad.
  double damping = 0.02;
  int steps = 5;

  // dq = J^T (J J^T + damping^2)^-1 e for the position of an end effector.
  void Solve(const Skeleton& skeleton, const std::string& end_effector_id,
             const Eigen::Vector3d& world_target, VectorView positions) const;
};

}  // namespace gelenk::benchmarks

#endif  // GELENK_TESTS_BENCHMARKS_IK_DAMPED_LEAST_SQUARES_H_
