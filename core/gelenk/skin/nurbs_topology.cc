#include "gelenk/skin/nurbs_topology.h"

#include <algorithm>

namespace gelenk {
namespace {

using Eigen::Vector3d;

// Of the surface's size: points of a row that is one point.
constexpr double kPole = 1e-9;

}  // namespace

NurbsTopology TopologyOf(const NurbsSurface& surface) {
  double size = 0;
  for (const Vector3d& point : surface.points) {
    size = std::max(size, (point - surface.points[0]).norm());
  }
  const int rows = surface.u.count();
  const int columns = surface.v.count();
  const auto is_point = [&](int first, int step, int count) {
    for (int k = 1; k < count; ++k) {
      if ((surface.points[first + k * step] - surface.points[first]).norm() >
          kPole * size) {
        return false;
      }
    }
    return true;
  };
  return {IsClosedInU(surface),
          IsClosedInV(surface),
          {is_point(0, 1, columns),
           is_point(surface.index(rows - 1, 0), 1, columns),
           is_point(0, columns, rows),
           is_point(surface.index(0, columns - 1), columns, rows)}};
}

WeldedGrid::WeldedGrid(int row_count, int column_count,
                       const NurbsTopology& topology)
    : rows(row_count),
      columns(column_count),
      vertex(static_cast<size_t>(row_count) * column_count, -1) {
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int r = topology.closed_u && i == rows - 1 ? 0 : i;
      const int c = topology.closed_v && j == columns - 1 ? 0 : j;
      int to_row = r, to_column = c;
      if ((topology.pole[0] && r == 0) || (topology.pole[1] && r == rows - 1)) {
        to_column = 0;
      }
      if ((topology.pole[2] && c == 0) ||
          (topology.pole[3] && c == columns - 1)) {
        to_row = 0;
      }
      int& own = vertex[i * columns + j];
      if (to_row != i || to_column != j) {
        own = vertex[to_row * columns + to_column];
      } else {
        own = static_cast<int>(first.size());
        first.emplace_back(i, j);
      }
    }
  }
}

std::vector<Triangle> WeldedGrid::Triangles() const {
  std::vector<Triangle> triangles;
  const auto add = [&](int a, int b, int c) {
    if (a != b && b != c && c != a) triangles.push_back({a, b, c});
  };
  for (int i = 0; i + 1 < rows; ++i) {
    for (int j = 0; j + 1 < columns; ++j) {
      const int* at = &vertex[i * columns + j];
      add(at[0], at[columns], at[columns + 1]);
      add(at[0], at[columns + 1], at[1]);
    }
  }
  return triangles;
}

}  // namespace gelenk
