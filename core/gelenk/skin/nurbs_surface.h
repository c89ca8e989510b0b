// NURBS surfaces: rational tensor-product B-splines of degree 1 .. 7.
//
// The control net has u_count x v_count points, point (i, j) at
// i * v_count + j, in m, skeleton frame at rest; knots are clamped or not, the
// domain is [knots[degree], knots[count]].
//
// Source: Piegl and Tiller, "The NURBS Book", 2nd ed., 1997: A2.1 - A2.3 (basis
// and derivatives), A5.4 (refinement).
#ifndef GELENK_SKIN_NURBS_SURFACE_H_
#define GELENK_SKIN_NURBS_SURFACE_H_

#include <Eigen/Core>
#include <vector>

#include "absl/status/status.h"
#include "absl/types/span.h"

namespace gelenk {

inline constexpr int kMaxNurbsDegree = 7;

struct NurbsAxis {
  int degree = 3;
  std::vector<double> knots;

  int count() const { return static_cast<int>(knots.size()) - degree - 1; }
  double start() const { return knots[degree]; }
  double end() const { return knots[count()]; }
};

struct NurbsSurface {
  NurbsAxis u;
  NurbsAxis v;
  std::vector<Eigen::Vector3d> points;
  std::vector<double> weights;  // > 0
  // Loops that cut parts away; surfaces that have some are refused.
  int trim_curve_count = 0;

  int index(int i, int j) const { return i * v.count() + j; }
};

// Along one axis: what determines a net from points is dense in it.
inline constexpr int kMaxNurbsCount = 512;

struct NurbsBounds {
  int max_points = 1 << 16;
};

// INVALID_ARGUMENT that lists what is wrong: degrees, numbers of knots and
// points, knots that fall or stand still too long (a surface that is torn),
// weights that are not > 0, numbers that are not finite. UNIMPLEMENTED for a
// trimmed surface.
absl::Status CheckNurbs(const NurbsSurface& surface,
                        const NurbsBounds& bounds = {});

// The functions that are not zero at a parameter: degree + 1 of them, from
// control point `first` on, and their derivatives.
struct NurbsBasis {
  int first = 0;
  double values[kMaxNurbsDegree + 1];
  double slopes[kMaxNurbsDegree + 1];
};
NurbsBasis BasisAt(const NurbsAxis& axis, double parameter);

struct NurbsPoint {
  Eigen::Vector3d position;
  Eigen::Vector3d along_u;
  Eigen::Vector3d along_v;
};
NurbsPoint EvaluateNurbs(const NurbsSurface& surface, double u, double v);

// The mean of the knots of each control point: where it has most to say. Each
// lies in the domain and the basis is regular there.
std::vector<double> GrevilleAbscissae(const NurbsAxis& axis);

// The same surface with more knots, which rise and lie inside the domain.
void RefineU(absl::Span<const double> knots, NurbsSurface& surface);
void RefineV(absl::Span<const double> knots, NurbsSurface& surface);

// Whether the first and the last row (or column) of the net are the same
// points with the same weights: a seam.
bool IsClosedInU(const NurbsSurface& surface);
bool IsClosedInV(const NurbsSurface& surface);

}  // namespace gelenk

#endif  // GELENK_SKIN_NURBS_SURFACE_H_
