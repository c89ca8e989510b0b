#include "gelenk/contact/ground.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/memory/memory.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

// A place on one axis of the grid: the node before it and the part of the way
// to the next.
struct GridPlace {
  Eigen::Index node;
  double part;
};

GridPlace PlaceOn(double coordinate, double origin, double spacing,
                  Eigen::Index count) {
  const double place = std::clamp((coordinate - origin) / spacing, 0.0,
                                  static_cast<double>(count - 1));
  const Eigen::Index node =
      std::min(static_cast<Eigen::Index>(place), count - 2);
  return {node, place - static_cast<double>(node)};
}

}  // namespace

absl::StatusOr<std::unique_ptr<HeightField>> HeightField::Create(
    Eigen::MatrixXd heights_m, double origin_x_m, double origin_z_m,
    double spacing_m) {
  Violations violations;
  if (heights_m.rows() < 2 || heights_m.cols() < 2) {
    violations.Add("heights_m",
                   absl::StrFormat("want 2 x 2 or more, got %d x %d",
                                   heights_m.rows(), heights_m.cols()));
  } else if (!heights_m.allFinite()) {
    violations.Add("heights_m", "holds a number that is not finite");
  }
  if (!std::isfinite(origin_x_m) || !std::isfinite(origin_z_m)) {
    violations.Add("origin", absl::StrFormat("not finite: %g, %g", origin_x_m,
                                             origin_z_m));
  }
  if (!(spacing_m > 0) || !std::isfinite(spacing_m)) {
    violations.Add("spacing_m",
                   absl::StrFormat("want more than 0, got %g", spacing_m));
  }
  if (!violations.empty()) return violations.ToStatus();
  return absl::WrapUnique(
      new HeightField(std::move(heights_m), origin_x_m, origin_z_m, spacing_m));
}

double HeightField::HeightAt(double x, double z) const {
  const GridPlace i = PlaceOn(x, origin_x_m_, spacing_m_, heights_m_.rows());
  const GridPlace k = PlaceOn(z, origin_z_m_, spacing_m_, heights_m_.cols());
  const auto along_x = [&](Eigen::Index column) {
    return (1 - i.part) * heights_m_(i.node, column) +
           i.part * heights_m_(i.node + 1, column);
  };
  return (1 - k.part) * along_x(k.node) + k.part * along_x(k.node + 1);
}

}  // namespace gelenk
