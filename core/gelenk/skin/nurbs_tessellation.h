// The parameters at which a fitted surface is drawn, and its bases there.
#ifndef GELENK_SKIN_NURBS_TESSELLATION_H_
#define GELENK_SKIN_NURBS_TESSELLATION_H_

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/skin/nurbs_fit.h"
#include "gelenk/skin/triangle_mesh.h"

namespace gelenk {

struct NurbsTessellation {
  // Bases at fixed parameters.
  struct AxisTable {
    std::vector<double> parameters;
    std::vector<int> first;
    std::vector<float> values;
    std::vector<float> slopes;
  };
  // Vertices without doubles at seams and poles.
  struct Grid {
    std::vector<int> slots;  // of vertices
    std::vector<Eigen::Vector2d> parameters;
    std::vector<Triangle> triangles;
    std::vector<Eigen::Vector3d> positions;  // at rest
  };
  AxisTable u;  // a row each
  AxisTable v;  // whole blocks of columns; the last are repeated
  int column_count = 0;
  Grid grid;
};

// So fine that chords are within the tolerance, at rest and at the probe poses.
// INVALID_ARGUMENT when that takes more than `max_vertices`.
absl::StatusOr<NurbsTessellation> TessellateNurbs(const NurbsFit& fit,
                                                  double tolerance_m,
                                                  int max_vertices);

}  // namespace gelenk

#endif  // GELENK_SKIN_NURBS_TESSELLATION_H_
