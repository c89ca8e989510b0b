// How a surface closes: seams and poles, and grids of parameters that have one
// vertex where a surface has one point.
#ifndef GELENK_SKIN_NURBS_TOPOLOGY_H_
#define GELENK_SKIN_NURBS_TOPOLOGY_H_

#include <utility>
#include <vector>

#include "gelenk/skin/nurbs_surface.h"
#include "gelenk/skin/triangle_mesh.h"

namespace gelenk {

// Open everywhere unless told.
struct NurbsTopology {
  bool closed_u = false;
  bool closed_v = false;
  // Whether the net is a single point along its first and last row, first and
  // last column.
  bool pole[4] = {};
};
NurbsTopology TopologyOf(const NurbsSurface& surface);

// A grid of parameters whose doubles at seams and poles are one vertex.
struct WeldedGrid {
  int rows;
  int columns;
  std::vector<int> vertex;                 // of each row and column
  std::vector<std::pair<int, int>> first;  // row and column of each vertex

  WeldedGrid(int row_count, int column_count, const NurbsTopology& topology);

  std::vector<Triangle> Triangles() const;
};

}  // namespace gelenk

#endif  // GELENK_SKIN_NURBS_TOPOLOGY_H_
