#include "gelenk/skin/mesh_places.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "absl/container/flat_hash_map.h"
#include "absl/container/inlined_vector.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

using Cell = std::array<int64_t, 3>;

// Cells are this many tolerances wide: a place near a border is looked for
// beyond it, the fewer the wider; places in one cell stay few.
constexpr double kCellOfTolerance = 4;

class PlaceGrid {
 public:
  PlaceGrid(const Vector3d& origin, double tolerance_m)
      : origin_(origin),
        tolerance_m_(tolerance_m),
        cell_m_(kCellOfTolerance * tolerance_m) {}

  // The first vertex that is as near as the tolerance; adds `vertex` if none.
  int FindOrAdd(int vertex, absl::Span<const Vector3d> positions) {
    const Vector3d& point = positions[vertex];
    const Cell low = CellOf(point - Vector3d::Constant(tolerance_m_));
    const Cell high = CellOf(point + Vector3d::Constant(tolerance_m_));
    Cell cell;
    for (cell[0] = low[0]; cell[0] <= high[0]; ++cell[0]) {
      for (cell[1] = low[1]; cell[1] <= high[1]; ++cell[1]) {
        for (cell[2] = low[2]; cell[2] <= high[2]; ++cell[2]) {
          const auto found = cells_.find(cell);
          if (found == cells_.end()) continue;
          for (int other : found->second) {
            if ((positions[other] - point).norm() <= tolerance_m_) return other;
          }
        }
      }
    }
    cells_[CellOf(point)].push_back(vertex);
    return vertex;
  }

 private:
  Cell CellOf(const Vector3d& point) const {
    Cell cell;
    for (int k = 0; k < 3; ++k) {
      cell[k] =
          static_cast<int64_t>(std::floor((point[k] - origin_[k]) / cell_m_));
    }
    return cell;
  }

  Vector3d origin_;
  double tolerance_m_;
  double cell_m_;
  absl::flat_hash_map<Cell, absl::InlinedVector<int, 2>> cells_;
};

}  // namespace

std::vector<int> FindPlaces(absl::Span<const Vector3d> positions) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& position : positions) box.extend(position);
  std::vector<int> places(positions.size(), 0);
  const double diagonal_m = positions.empty() ? 0 : box.diagonal().norm();
  if (!(diagonal_m > 0)) return places;
  PlaceGrid grid(box.min(), kPlaceTolerance * diagonal_m);
  for (size_t v = 0; v < positions.size(); ++v) {
    places[v] = grid.FindOrAdd(static_cast<int>(v), positions);
  }
  return places;
}

MeshEdges FindEdgesOfPlaces(absl::Span<const Triangle> triangles,
                            absl::Span<const int> places) {
  std::vector<Triangle> welded;
  welded.reserve(triangles.size());
  for (const Triangle& triangle : triangles) {
    const Triangle corners(places[triangle[0]], places[triangle[1]],
                           places[triangle[2]]);
    // A sliver within one place has no edges.
    if (corners.minCoeff() != corners.maxCoeff()) welded.push_back(corners);
  }
  return FindEdges(static_cast<int>(places.size()), welded);
}

std::vector<int> FindComponentsOfPlaces(absl::Span<const Triangle> triangles,
                                        absl::Span<const int> places) {
  std::vector<int> components =
      FindComponents(FindEdgesOfPlaces(triangles, places));
  // Vertices that are not the first of their place were alone: without their
  // numbers the others' are counted afresh.
  std::vector<int> numbers(components.size(), -1);
  int found = 0;
  for (size_t v = 0; v < places.size(); ++v) {
    const int first = places[v];
    if (first == static_cast<int>(v)) {
      int& number = numbers[components[v]];
      if (number < 0) number = found++;
      components[v] = number;
    } else {
      components[v] = components[first];
    }
  }
  return components;
}

}  // namespace gelenk
