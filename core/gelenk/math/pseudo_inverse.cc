#include "gelenk/math/pseudo_inverse.h"

#include <Eigen/SVD>

namespace gelenk {
namespace {

// The one instance of it: half a minute of a compiler's time for every other.
using Svd = Eigen::JacobiSVD<Eigen::MatrixXd>;

}  // namespace

PseudoInverse ComputePseudoInverse(const Eigen::MatrixXd& j) {
  PseudoInverse result;
  result.matrix.setZero(j.cols(), j.rows());
  if (j.size() == 0) return result;
  const Svd svd(j, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& values = svd.singularValues();
  while (result.rank < values.size() && values[result.rank] > 0 &&
         values[result.rank] > kRankCutoff * values[0]) {
    ++result.rank;
  }
  result.matrix = svd.matrixV().leftCols(result.rank) *
                  values.head(result.rank).cwiseInverse().asDiagonal() *
                  svd.matrixU().leftCols(result.rank).transpose();
  return result;
}

Eigen::VectorXd ComputeSingularValues(const Eigen::MatrixXd& j) {
  if (j.size() == 0) return Eigen::VectorXd();
  return Svd(j).singularValues();
}

}  // namespace gelenk
