#include "gelenk/skin/nurbs_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/skin/triangle_mesh.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

// Points that are nearer to each other are the same, relative to the net's
// size.
constexpr double kSameTolerance = 1e-9;
// Weights beyond lose the digits of the others.
constexpr double kMaxWeight = 1e6;

void CheckAxis(const NurbsAxis& axis, const std::string& field,
               Violations& violations) {
  if (axis.degree < 1 || axis.degree > kMaxNurbsDegree) {
    violations.Add(
        field + "_degree",
        absl::StrCat("want 1 to ", kMaxNurbsDegree, ", got ", axis.degree));
    return;
  }
  const int least = 2 * (axis.degree + 1);
  if (static_cast<int>(axis.knots.size()) < least) {
    violations.Add(field + "_knots",
                   absl::StrCat("want at least ", least, " for degree ",
                                axis.degree, ", got ", axis.knots.size()));
    return;
  }
  if (axis.count() > kMaxNurbsCount) {
    violations.Add(field + "_knots",
                   absl::StrCat("want at most ", kMaxNurbsCount,
                                " control points, got ", axis.count()));
    return;
  }
  for (size_t i = 0; i < axis.knots.size(); ++i) {
    if (!std::isfinite(axis.knots[i])) {
      violations.Add(absl::StrCat(field, "_knots[", i, "]"),
                     absl::StrCat("want a finite number, got ", axis.knots[i]));
      return;
    }
    if (i > 0 && axis.knots[i] < axis.knots[i - 1]) {
      violations.Add(absl::StrCat(field, "_knots[", i, "]"),
                     absl::StrCat("falls from ", axis.knots[i - 1], " to ",
                                  axis.knots[i]));
      return;
    }
  }
  if (!(axis.start() < axis.end())) {
    violations.Add(field + "_knots",
                   absl::StrCat("the domain is empty, from ", axis.start(),
                                " to ", axis.end()));
    return;
  }
  int repeated = 1;
  for (size_t i = 1; i < axis.knots.size(); ++i) {
    repeated = axis.knots[i] == axis.knots[i - 1] ? repeated + 1 : 1;
    const bool at_end =
        axis.knots[i] <= axis.start() || axis.knots[i] >= axis.end();
    if (repeated > (at_end ? axis.degree + 1 : axis.degree)) {
      violations.Add(absl::StrCat(field, "_knots[", i, "]"),
                     absl::StrCat(axis.knots[i], " is there ", repeated,
                                  " times: the surface is torn"));
      return;
    }
  }
}

// The last knot span that begins at or before `parameter`.
int SpanAt(const NurbsAxis& axis, double parameter) {
  const auto begin = axis.knots.begin() + axis.degree;
  const auto end = axis.knots.begin() + axis.count();
  const auto after = std::upper_bound(begin, end, parameter);
  int span = static_cast<int>(after - axis.knots.begin()) - 1;
  span = std::clamp(span, axis.degree, axis.count() - 1);
  while (axis.knots[span] == axis.knots[span + 1]) --span;
  return span;
}

// One knot more in a row of homogeneous points (Boehm).
void InsertKnot(const NurbsAxis& axis, double knot,
                const std::vector<Vector4d>& row,
                std::vector<Vector4d>& refined) {
  const int p = axis.degree;
  const int span = SpanAt(axis, knot);
  refined.resize(row.size() + 1);
  for (int i = 0; i < static_cast<int>(refined.size()); ++i) {
    if (i <= span - p) {
      refined[i] = row[i];
    } else if (i > span) {
      refined[i] = row[i - 1];
    } else {
      const double x =
          (knot - axis.knots[i]) / (axis.knots[i + p] - axis.knots[i]);
      refined[i] = (1 - x) * row[i - 1] + x * row[i];
    }
  }
}

// Rows run along the axis that is refined.
std::vector<Vector4d> Homogeneous(const NurbsSurface& surface) {
  std::vector<Vector4d> points;
  for (size_t i = 0; i < surface.points.size(); ++i) {
    Vector4d& point = points.emplace_back();
    point << surface.weights[i] * surface.points[i], surface.weights[i];
  }
  return points;
}

template <typename IndexOf>
void Refine(absl::Span<const double> knots, bool along_u, IndexOf index_of,
            NurbsSurface& surface) {
  NurbsAxis& axis = along_u ? surface.u : surface.v;
  const int rows = along_u ? surface.v.count() : surface.u.count();
  const std::vector<Vector4d> net = Homogeneous(surface);
  NurbsAxis refined_axis;
  std::vector<std::vector<Vector4d>> refined_rows;
  for (int r = 0; r < rows; ++r) {
    std::vector<Vector4d> row;
    row.reserve(axis.count() + knots.size());
    for (int i = 0; i < axis.count(); ++i) {
      row.push_back(net[index_of(surface, r, i)]);
    }
    refined_axis = axis;
    std::vector<Vector4d> next;
    for (double knot : knots) {
      InsertKnot(refined_axis, knot, row, next);
      std::swap(row, next);
      refined_axis.knots.insert(
          std::upper_bound(refined_axis.knots.begin(), refined_axis.knots.end(),
                           knot),
          knot);
    }
    refined_rows.push_back(std::move(row));
  }
  axis = refined_axis;
  surface.points.resize(static_cast<size_t>(rows) * axis.count());
  surface.weights.resize(surface.points.size());
  for (int r = 0; r < rows; ++r) {
    for (int i = 0; i < axis.count(); ++i) {
      const Vector4d& point = refined_rows[r][i];
      const int at = index_of(surface, r, i);
      surface.points[at] = point.head<3>() / point[3];
      surface.weights[at] = point[3];
    }
  }
}

bool AreSame(const NurbsSurface& surface, int a, int b) {
  const double size =
      (surface.points[a].cwiseAbs() + surface.points[b].cwiseAbs()).sum() + 1;
  return (surface.points[a] - surface.points[b]).norm() <=
             kSameTolerance * size &&
         std::abs(surface.weights[a] - surface.weights[b]) <=
             kSameTolerance * surface.weights[a];
}

}  // namespace

absl::Status CheckNurbs(const NurbsSurface& surface,
                        const NurbsBounds& bounds) {
  if (surface.trim_curve_count != 0) {
    return absl::UnimplementedError(absl::StrCat(
        "trim_curve_count: trimmed surfaces cannot be deformed, got ",
        surface.trim_curve_count,
        " loops; send the surface untrimmed, or as a triangle mesh"));
  }
  Violations violations;
  CheckAxis(surface.u, "u", violations);
  CheckAxis(surface.v, "v", violations);
  if (!violations.empty()) return violations.ToStatus();
  const int64_t size = int64_t{surface.u.count()} * surface.v.count();
  if (size > bounds.max_points) {
    violations.Add("points", absl::StrCat("want at most ", bounds.max_points,
                                          ", got ", size));
    return violations.ToStatus();
  }
  if (static_cast<int64_t>(surface.points.size()) != size) {
    violations.Add("points", absl::StrCat("the knots want ", surface.u.count(),
                                          " x ", surface.v.count(), ", got ",
                                          surface.points.size()));
  }
  if (surface.weights.size() != surface.points.size()) {
    violations.Add("weights", absl::StrCat("want ", surface.points.size(),
                                           ", got ", surface.weights.size()));
  }
  for (size_t i = 0; i < surface.points.size(); ++i) {
    if (!(surface.points[i].allFinite() &&
          surface.points[i].cwiseAbs().maxCoeff() <= kMaxMeshCoordinateM)) {
      violations.Add(
          absl::StrCat("points[", i, "]"),
          absl::StrCat("want coordinates within ", kMaxMeshCoordinateM));
    }
  }
  for (size_t i = 0; i < surface.weights.size(); ++i) {
    if (!(surface.weights[i] >= 1 / kMaxWeight &&
          surface.weights[i] <= kMaxWeight)) {
      violations.Add(absl::StrCat("weights[", i, "]"),
                     absl::StrCat("want a number > 0, ", 1 / kMaxWeight, " to ",
                                  kMaxWeight, ", got ", surface.weights[i]));
    }
  }
  return violations.ToStatus();
}

NurbsBasis BasisAt(const NurbsAxis& axis, double parameter) {
  const int p = axis.degree;
  const int span = SpanAt(axis, parameter);
  NurbsBasis basis;
  basis.first = span - p;
  double left[kMaxNurbsDegree + 1];
  double right[kMaxNurbsDegree + 1];
  double lower[kMaxNurbsDegree + 1] = {};  // of degree p - 1
  double* n = basis.values;
  n[0] = 1;
  for (int j = 1; j <= p; ++j) {
    if (j == p) std::copy(n, n + p, lower);
    left[j] = parameter - axis.knots[span + 1 - j];
    right[j] = axis.knots[span + j] - parameter;
    double saved = 0;
    for (int r = 0; r < j; ++r) {
      const double part = n[r] / (right[r + 1] + left[j - r]);
      n[r] = saved + right[r + 1] * part;
      saved = left[j - r] * part;
    }
    n[j] = saved;
  }
  for (int i = 0; i <= p; ++i) {
    const auto part = [&](int k) {
      return lower[k] /
             (axis.knots[span + k + 1] - axis.knots[span + k + 1 - p]);
    };
    basis.slopes[i] = p * ((i > 0 ? part(i - 1) : 0) - (i < p ? part(i) : 0));
  }
  return basis;
}

NurbsPoint EvaluateNurbs(const NurbsSurface& surface, double u, double v) {
  const NurbsBasis bu = BasisAt(surface.u, u);
  const NurbsBasis bv = BasisAt(surface.v, v);
  Vector4d sum = Vector4d::Zero(), by_u = sum, by_v = sum;
  for (int i = 0; i <= surface.u.degree; ++i) {
    for (int j = 0; j <= surface.v.degree; ++j) {
      const int at = surface.index(bu.first + i, bv.first + j);
      Vector4d point;
      point << surface.weights[at] * surface.points[at], surface.weights[at];
      sum += bu.values[i] * bv.values[j] * point;
      by_u += bu.slopes[i] * bv.values[j] * point;
      by_v += bu.values[i] * bv.slopes[j] * point;
    }
  }
  const Vector3d position = sum.head<3>() / sum[3];
  return {position, (by_u.head<3>() - by_u[3] * position) / sum[3],
          (by_v.head<3>() - by_v[3] * position) / sum[3]};
}

std::vector<double> GrevilleAbscissae(const NurbsAxis& axis) {
  std::vector<double> abscissae;
  for (int i = 0; i < axis.count(); ++i) {
    double sum = 0;
    for (int k = 1; k <= axis.degree; ++k) sum += axis.knots[i + k];
    abscissae.push_back(
        std::clamp(sum / axis.degree, axis.start(), axis.end()));
  }
  return abscissae;
}

void RefineU(absl::Span<const double> knots, NurbsSurface& surface) {
  Refine(
      knots, true,
      [](const NurbsSurface& s, int row, int i) { return s.index(i, row); },
      surface);
}

void RefineV(absl::Span<const double> knots, NurbsSurface& surface) {
  Refine(
      knots, false,
      [](const NurbsSurface& s, int row, int i) { return s.index(row, i); },
      surface);
}

bool IsClosedInU(const NurbsSurface& surface) {
  for (int j = 0; j < surface.v.count(); ++j) {
    if (!AreSame(surface, surface.index(0, j),
                 surface.index(surface.u.count() - 1, j))) {
      return false;
    }
  }
  return true;
}

bool IsClosedInV(const NurbsSurface& surface) {
  for (int i = 0; i < surface.u.count(); ++i) {
    if (!AreSame(surface, surface.index(i, 0),
                 surface.index(i, surface.v.count() - 1))) {
      return false;
    }
  }
  return true;
}

}  // namespace gelenk
