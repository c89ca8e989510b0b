#include "gelenk/skin/nurbs_tessellation.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "gelenk/skin/nurbs_collocation.h"
#include "gelenk/skin/vertex_blocks.h"

namespace gelenk {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kMaxSegmentsPerSpan = 16;

// Parameters so close that chords are within the tolerance.
std::vector<double> ChordParameters(const NurbsFit& fit, bool along_u,
                                    double tolerance_m) {
  const NurbsAxis& axis = along_u ? fit.surface.u : fit.surface.v;
  const NurbsAxis& other = along_u ? fit.surface.v : fit.surface.u;
  std::vector<NurbsSurface> surfaces = fit.deformed;
  surfaces.push_back(fit.surface);
  const std::vector<double> ends = SpanEnds(axis);
  const std::vector<double> across = GrevilleAbscissae(other);
  std::vector<double> parameters = {ends[0]};
  for (size_t i = 0; i + 1 < ends.size(); ++i) {
    double sagitta = 0;
    for (const NurbsSurface& surface : surfaces) {
      for (double w : across) {
        const auto at = [&](double x) {
          return along_u ? EvaluateNurbs(surface, x, w).position
                         : EvaluateNurbs(surface, w, x).position;
        };
        const Vector3d chord = 0.5 * (at(ends[i]) + at(ends[i + 1]));
        sagitta = std::max(sagitta,
                           (at(0.5 * (ends[i] + ends[i + 1])) - chord).norm());
      }
    }
    // It falls with the square of the number of chords.
    const int segments = std::clamp(
        static_cast<int>(std::ceil(std::sqrt(sagitta / tolerance_m))), 1,
        kMaxSegmentsPerSpan);
    for (int k = 1; k <= segments; ++k) {
      parameters.push_back(
          k == segments ? ends[i + 1]
                        : ends[i] + k * (ends[i + 1] - ends[i]) / segments);
    }
  }
  return parameters;
}

// By parameter, or, transposed, by function.
void FillTable(const NurbsAxis& axis, bool transposed,
               NurbsTessellation::AxisTable& table) {
  const size_t count = table.parameters.size();
  const size_t functions = axis.degree + 1;
  table.values.resize(count * functions);
  table.slopes.resize(count * functions);
  for (size_t i = 0; i < count; ++i) {
    const NurbsBasis basis = BasisAt(axis, table.parameters[i]);
    table.first.push_back(basis.first);
    for (size_t k = 0; k < functions; ++k) {
      const size_t at = transposed ? k * count + i : i * functions + k;
      table.values[at] = static_cast<float>(basis.values[k]);
      table.slopes[at] = static_cast<float>(basis.slopes[k]);
    }
  }
}

}  // namespace

absl::StatusOr<NurbsTessellation> TessellateNurbs(const NurbsFit& fit,
                                                  double tolerance_m,
                                                  int max_vertices) {
  NurbsTessellation tessellation;
  tessellation.u.parameters = ChordParameters(fit, true, tolerance_m);
  tessellation.v.parameters = ChordParameters(fit, false, tolerance_m);
  const int rows = static_cast<int>(tessellation.u.parameters.size());
  const int columns = static_cast<int>(tessellation.v.parameters.size());
  if (static_cast<int64_t>(rows) * columns > max_vertices) {
    return absl::InvalidArgumentError(
        absl::StrCat("tolerance_m: ", tolerance_m, " m makes ", rows, " x ",
                     columns, " vertices, want at most ", max_vertices));
  }
  tessellation.column_count = columns;
  const int padded = BlocksFor(columns) * kVerticesPerBlock;
  const WeldedGrid grid(rows, columns, fit.topology);
  for (const auto& [i, j] : grid.first) {
    const Vector2d at(tessellation.u.parameters[i],
                      tessellation.v.parameters[j]);
    tessellation.grid.slots.push_back(padded * i + j);
    tessellation.grid.parameters.push_back(at);
    tessellation.grid.positions.push_back(
        EvaluateNurbs(fit.surface, at[0], at[1]).position);
  }
  tessellation.grid.triangles = grid.Triangles();
  tessellation.v.parameters.resize(padded, tessellation.v.parameters.back());
  FillTable(fit.surface.u, false, tessellation.u);
  FillTable(fit.surface.v, true, tessellation.v);
  return tessellation;
}

}  // namespace gelenk
