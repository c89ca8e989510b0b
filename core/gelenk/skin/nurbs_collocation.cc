#include "gelenk/skin/nurbs_collocation.h"

namespace gelenk {

using Eigen::MatrixXd;

MatrixXd Collocation(const NurbsAxis& axis,
                     const std::vector<double>& parameters) {
  MatrixXd matrix = MatrixXd::Zero(parameters.size(), axis.count());
  for (size_t row = 0; row < parameters.size(); ++row) {
    const NurbsBasis basis = BasisAt(axis, parameters[row]);
    for (int i = 0; i <= axis.degree; ++i) {
      matrix(row, basis.first + i) = basis.values[i];
    }
  }
  return matrix;
}

std::vector<double> GrevilleWeights(const NurbsSurface& surface) {
  using RowMajor = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;
  const int rows = surface.u.count(), columns = surface.v.count();
  std::vector<double> weights(surface.points.size());
  Eigen::Map<RowMajor>(weights.data(), rows, columns) =
      Collocation(surface.u, GrevilleAbscissae(surface.u)) *
      Eigen::Map<const RowMajor>(surface.weights.data(), rows, columns) *
      Collocation(surface.v, GrevilleAbscissae(surface.v)).transpose();
  return weights;
}

std::vector<double> SpanEnds(const NurbsAxis& axis) {
  std::vector<double> ends;
  for (double knot : axis.knots) {
    if (knot < axis.start() || knot > axis.end()) continue;
    if (ends.empty() || knot > ends.back()) ends.push_back(knot);
  }
  return ends;
}

}  // namespace gelenk
