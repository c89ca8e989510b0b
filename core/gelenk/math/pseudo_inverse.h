// The Moore-Penrose inverse of a matrix that may lack rank.
#ifndef GELENK_MATH_PSEUDO_INVERSE_H_
#define GELENK_MATH_PSEUDO_INVERSE_H_

#include <Eigen/Core>

namespace gelenk {

// Singular values below this part of the largest count as zero: far above the
// rounding of a Jacobian (1e-15), far below what a motion of use has.
inline constexpr double kRankCutoff = 1e-9;

struct PseudoInverse {
  // Columns x rows of the matrix.
  Eigen::MatrixXd matrix;
  int rank = 0;
};

// By singular values, those below kRankCutoff of the largest left out. With
// full row rank it equals J^T (J J^T)^-1. Any size, also without rows or
// columns. Allocates; cost: cubic in the smaller side.
PseudoInverse ComputePseudoInverse(const Eigen::MatrixXd& j);

// Falling; none for a matrix without rows or columns. Allocates; cost: cubic in
// the smaller side.
Eigen::VectorXd ComputeSingularValues(const Eigen::MatrixXd& j);

}  // namespace gelenk

#endif  // GELENK_MATH_PSEUDO_INVERSE_H_
