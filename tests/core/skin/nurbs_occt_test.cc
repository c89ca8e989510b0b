// Evaluation of NURBS surfaces against another library's, Open CASCADE, where
// it is installed (Debian: libocct-modeling-data-dev).

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Geom_BSplineSurface.hxx>
#include <algorithm>
#include <utility>
#include <vector>

#include "gelenk/skin/nurbs_surface.h"
#include "tests/testing/random.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomVector;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::UniformIndex;

// Surfaces of some 2 m; two orders of summation.
constexpr double kTolerance = 1e-12;

// Clamped, with single and multiple knots.
NurbsAxis RandomAxis(Random& random, int degree) {
  NurbsAxis axis{degree, std::vector<double>(degree + 1, -1.0)};
  double knot = -1;
  for (int spans = UniformIndex(random, 4); spans > 0; --spans) {
    knot += Uniform(random, 0.1, 2);
    axis.knots.insert(axis.knots.end(), 1 + UniformIndex(random, degree), knot);
  }
  axis.knots.insert(axis.knots.end(), degree + 1, knot + 1);
  return axis;
}

// Knots once each, and how often.
std::pair<TColStd_Array1OfReal, TColStd_Array1OfInteger> CountedKnots(
    const NurbsAxis& axis) {
  std::vector<double> knots = axis.knots;
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  const int count = static_cast<int>(knots.size());
  TColStd_Array1OfReal once(1, count);
  TColStd_Array1OfInteger times(1, count);
  for (int i = 0; i < count; ++i) {
    once.SetValue(i + 1, knots[i]);
    times.SetValue(i + 1, static_cast<int>(std::count(
                              axis.knots.begin(), axis.knots.end(), knots[i])));
  }
  return {once, times};
}

Handle(Geom_BSplineSurface) TheSame(const NurbsSurface& surface) {
  const int rows = surface.u.count(), columns = surface.v.count();
  TColgp_Array2OfPnt points(1, rows, 1, columns);
  TColStd_Array2OfReal weights(1, rows, 1, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const Vector3d& point = surface.points[surface.index(i, j)];
      points.SetValue(i + 1, j + 1, gp_Pnt(point.x(), point.y(), point.z()));
      weights.SetValue(i + 1, j + 1, surface.weights[surface.index(i, j)]);
    }
  }
  const auto [u_knots, u_times] = CountedKnots(surface.u);
  const auto [v_knots, v_times] = CountedKnots(surface.v);
  return new Geom_BSplineSurface(points, weights, u_knots, v_knots, u_times,
                                 v_times, surface.u.degree, surface.v.degree);
}

template <class Triple>
Vector3d VectorOf(const Triple& triple) {
  return {triple.X(), triple.Y(), triple.Z()};
}

TEST(NurbsOcctTest, PositionsAndNormalsAreTheSame) {
  Random random(1);
  for (int repeat = 0; repeat < 60; ++repeat) {
    NurbsSurface surface;
    surface.u = RandomAxis(random, 1 + repeat % kMaxNurbsDegree);
    surface.v = RandomAxis(random, 1 + UniformIndex(random, kMaxNurbsDegree));
    for (int i = 0; i < surface.u.count() * surface.v.count(); ++i) {
      surface.points.push_back(RandomVector(random, 1));
      surface.weights.push_back(Uniform(random, 0.5, 2));
    }
    ASSERT_TRUE(CheckNurbs(surface).ok()) << CheckNurbs(surface);
    const Handle(Geom_BSplineSurface) oracle = TheSame(surface);
    for (int k = 0; k < 100; ++k) {
      const double u = Uniform(random, surface.u.start(), surface.u.end());
      const double v = Uniform(random, surface.v.start(), surface.v.end());
      gp_Pnt position;
      gp_Vec along_u, along_v;
      oracle->D1(u, v, position, along_u, along_v);
      const NurbsPoint got = EvaluateNurbs(surface, u, v);
      EXPECT_LT((got.position - VectorOf(position)).norm(), kTolerance);
      const Vector3d want_u = VectorOf(along_u), want_v = VectorOf(along_v);
      EXPECT_LT((got.along_u - want_u).norm(),
                kTolerance * std::max(1.0, want_u.norm()));
      EXPECT_LT((got.along_v - want_v).norm(),
                kTolerance * std::max(1.0, want_v.norm()));
      // A normal is as certain as its two directions are apart.
      const Vector3d want = want_u.cross(want_v);
      const double apart = want.norm() / (want_u.norm() * want_v.norm());
      EXPECT_LT(
          (got.along_u.cross(got.along_v).normalized() - want.normalized())
              .norm(),
          kTolerance / std::min(1.0, apart));
    }
  }
}

}  // namespace
}  // namespace gelenk
