#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/skin/nurbs_skin.h"
#include "gelenk/skin/nurbs_surface.h"
#include "tests/core/skin/mesh_checks.h"
#include "tests/core/skin/skin_chains.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::ElbowAt;
using ::gelenk::testing::Fails;
using ::gelenk::testing::IsClosed;
using ::gelenk::testing::NormalsOf;
using ::gelenk::testing::PositionsOf;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomTransform;
using ::gelenk::testing::RandomVector;
using ::gelenk::testing::TwoLinkArm;
using ::gelenk::testing::Uniform;

const double kHalfTurnWeight = std::sqrt(0.5);

// A circle of degree 2 in four arcs: exact, because rational.
struct Circle {
  std::vector<double> knots = {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4};
  double x[9] = {1, 1, 0, -1, -1, -1, 0, 1, 1};
  double y[9] = {0, 1, 1, 1, 0, -1, -1, -1, 0};
  static double weight(int i) { return i % 2 ? kHalfTurnWeight : 1; }
};

// Around X, 2 m long, closed in u; degree 3 along v with `spans` spans.
NurbsSurface Tube(double radius_m, int spans = 4) {
  const Circle circle;
  NurbsSurface surface;
  surface.u = {2, circle.knots};
  surface.v.knots.assign(4, 0);
  for (int i = 1; i < spans; ++i) surface.v.knots.push_back(i);
  surface.v.knots.insert(surface.v.knots.end(), 4, spans);
  const std::vector<double> along = GrevilleAbscissae(surface.v);
  for (int i = 0; i < 9; ++i) {
    for (double v : along) {
      surface.points.emplace_back(2 * v / spans, radius_m * circle.x[i],
                                  radius_m * circle.y[i]);
      surface.weights.push_back(Circle::weight(i));
    }
  }
  return surface;
}

// A sphere about (0.4, 0, 0): closed in u, with poles at both ends of v.
NurbsSurface Sphere(double radius_m) {
  const Circle circle;
  NurbsSurface surface;
  surface.u = {2, circle.knots};
  surface.v = {2, {0, 0, 0, 1, 1, 2, 2, 2}};
  const double along[5] = {-1, -1, 0, 1, 1};
  const double across[5] = {0, 1, 1, 1, 0};
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 5; ++j) {
      surface.points.emplace_back(0.4 + radius_m * along[j],
                                  radius_m * across[j] * circle.x[i],
                                  radius_m * across[j] * circle.y[i]);
      surface.weights.push_back(Circle::weight(i) * Circle::weight(j));
    }
  }
  return surface;
}

NurbsSurface RandomSurface(Random& random) {
  NurbsSurface surface;
  surface.u = {3, {0, 0, 0, 0, 0.3, 0.5, 0.5, 1, 1, 1, 1}};
  surface.v = {2, {-1, -1, -1, 0, 0, 2, 3, 3, 3}};
  for (int i = 0; i < surface.u.count() * surface.v.count(); ++i) {
    surface.points.push_back(RandomVector(random, 1));
    surface.weights.push_back(Uniform(random, 0.5, 2));
  }
  return surface;
}

TEST(NurbsSurfaceTest, BasisIsAPartitionOfUnityWithItsSlopes) {
  Random random(1);
  const NurbsSurface surface = RandomSurface(random);
  for (const NurbsAxis& axis : {surface.u, surface.v}) {
    for (int k = 0; k < 200; ++k) {
      const double x = Uniform(random, axis.start(), axis.end());
      const NurbsBasis basis = BasisAt(axis, x);
      double sum = 0, slopes = 0;
      for (int i = 0; i <= axis.degree; ++i) {
        EXPECT_GE(basis.values[i], 0);
        sum += basis.values[i];
        slopes += basis.slopes[i];
      }
      EXPECT_NEAR(sum, 1, 1e-14);
      EXPECT_NEAR(slopes, 0, 1e-12);
    }
  }
}

TEST(NurbsSurfaceTest, TubeIsRoundAndSphereToo) {
  const NurbsSurface tube = Tube(0.2);
  const NurbsSurface sphere = Sphere(0.3);
  for (double u = 0; u <= 4; u += 0.05) {
    for (double v = 0; v <= 2; v += 0.1) {
      const Vector3d p = EvaluateNurbs(tube, u, v).position;
      EXPECT_NEAR(std::hypot(p.y(), p.z()), 0.2, 1e-14);
      const Vector3d q = EvaluateNurbs(sphere, u, v).position;
      EXPECT_NEAR((q - Vector3d(0.4, 0, 0)).norm(), 0.3, 1e-14);
    }
  }
}

TEST(NurbsSurfaceTest, SlopesAreThoseOfTheSurface) {
  Random random(2);
  const NurbsSurface surface = RandomSurface(random);
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 100; ++k) {
    const double u = Uniform(random, 0.01, 0.29);
    const double v = Uniform(random, 2.01, 2.99);
    const NurbsPoint point = EvaluateNurbs(surface, u, v);
    const Vector3d by_u = (EvaluateNurbs(surface, u + kStep, v).position -
                           EvaluateNurbs(surface, u - kStep, v).position) /
                          (2 * kStep);
    const Vector3d by_v = (EvaluateNurbs(surface, u, v + kStep).position -
                           EvaluateNurbs(surface, u, v - kStep).position) /
                          (2 * kStep);
    EXPECT_LE((point.along_u - by_u).norm(), 1e-7);
    EXPECT_LE((point.along_v - by_v).norm(), 1e-7);
  }
}

TEST(NurbsSurfaceTest, RefinementChangesNothing) {
  Random random(3);
  const NurbsSurface surface = RandomSurface(random);
  NurbsSurface refined = surface;
  RefineU({0.1, 0.1, 0.4, 0.75}, refined);
  RefineV({-0.5, 1, 2.5}, refined);
  EXPECT_EQ(refined.u.count(), surface.u.count() + 4);
  EXPECT_EQ(refined.v.count(), surface.v.count() + 3);
  ASSERT_TRUE(CheckNurbs(refined).ok());
  for (int k = 0; k < 200; ++k) {
    const double u = Uniform(random, 0, 1), v = Uniform(random, -1, 3);
    EXPECT_LE((EvaluateNurbs(refined, u, v).position -
               EvaluateNurbs(surface, u, v).position)
                  .norm(),
              1e-13);
  }
}

TEST(NurbsSurfaceTest, SaysWhatIsWrong) {
  const auto code = absl::StatusCode::kInvalidArgument;
  const NurbsSurface good = Tube(0.2);
  ASSERT_TRUE(CheckNurbs(good).ok());
  NurbsSurface bad = good;
  bad.v.knots[5] = bad.v.knots[4] - 2;
  EXPECT_THAT(CheckNurbs(bad), Fails(code, "v_knots[5]: falls from"));
  bad = good;
  bad.u.degree = 8;
  EXPECT_THAT(CheckNurbs(bad), Fails(code, "u_degree: want 1 to 7, got 8"));
  bad = good;
  bad.u.knots.pop_back();
  EXPECT_THAT(CheckNurbs(bad), Fails(code, "points: the knots want 8 x 7"));
  bad = good;
  bad.weights[3] = 0;
  EXPECT_THAT(CheckNurbs(bad), Fails(code, "weights[3]"));
  bad.weights[3] = std::nan("");
  EXPECT_THAT(CheckNurbs(bad), Fails(code, "weights[3]"));
  bad = good;
  bad.u.knots = {0, 0, 0, 1, 1, 1, 3, 3, 3, 4, 4, 4};
  EXPECT_THAT(CheckNurbs(bad), Fails(code, "is there 3 times: the surface is"));
  bad = good;
  bad.u.knots.assign(12, 1);
  EXPECT_THAT(CheckNurbs(bad), Fails(code, "the domain is empty"));
  bad = good;
  bad.v.knots[4] = HUGE_VAL;
  EXPECT_THAT(CheckNurbs(bad), Fails(code, "v_knots[4]: want a finite"));
  bad = good;
  bad.points[1].x() = std::nan("");
  EXPECT_THAT(CheckNurbs(bad), Fails(code, "points[1]"));
  bad = good;
  bad.u.knots.resize(3);
  EXPECT_THAT(CheckNurbs(bad), Fails(code, "u_knots: want at least 6"));
  bad = good;
  bad.v.knots.resize(kMaxNurbsCount + 5, 4);
  EXPECT_THAT(CheckNurbs(bad),
              Fails(code, "v_knots: want at most 512 control points, got 513"));
  bad = good;
  bad.trim_curve_count = 2;
  EXPECT_THAT(CheckNurbs(bad),
              Fails(absl::StatusCode::kUnimplemented, "trimmed surfaces"));
}

class NurbsSkinTest : public ::testing::Test {
 protected:
  std::shared_ptr<const NurbsSkin> Create(const NurbsSurface& surface,
                                          double tolerance_m = 1e-3) const {
    NurbsSkinOptions options;
    options.tolerance_m = tolerance_m;
    return NurbsSkin::Create(*rig_, surface, options).value();
  }

  std::shared_ptr<const Skeleton> arm_ = TwoLinkArm(Vector3d::UnitZ());
  std::shared_ptr<const VolumeRig> rig_ = [this] {
    SkinLinkOptions options;
    options.slenderness = 0.3;
    return VolumeRig::Create(arm_, options).value();
  }();
  SkinWorkspace workspace_;
  VertexBlocks blocks_;
};

TEST_F(NurbsSkinTest, RestPoseAndRigidMotionsAreExact) {
  Random random(4);
  const auto skin = Create(Tube(0.2));
  for (const RigidTransform& base :
       {RigidTransform(), RandomTransform(random, 1)}) {
    const NurbsSurface deformed =
        skin->DeformedSurface(ElbowAt(*arm_, 0), base);
    for (size_t i = 0; i < deformed.points.size(); ++i) {
      EXPECT_LE((deformed.points[i] - base * skin->surface().points[i]).norm(),
                1e-12);
    }
  }
}

TEST_F(NurbsSkinTest, RefinesUntilItFollowsTheVolumes) {
  double last_points = 0;
  for (double tolerance : {1e-2, 1e-3, 1e-4}) {
    const auto skin = Create(Tube(0.2), tolerance);
    EXPECT_LE(skin->estimated_error_m(), tolerance);
    EXPECT_GE(skin->surface().points.size(), last_points);
    last_points = static_cast<double>(skin->surface().points.size());
    // A bend that was no probe: points of the surface, deformed themselves.
    VolumeFrame frame;
    const Eigen::VectorXd pose = ElbowAt(*arm_, 0.5);
    rig_->Evaluate(pose, {}, frame);
    const NurbsSurface deformed = skin->DeformedSurface(pose, {});
    const double end = deformed.v.end();
    for (double u = 0; u <= 4; u += 0.23) {
      for (double v = 0; v <= end; v += 0.11) {
        const Vector3d rest = EvaluateNurbs(skin->surface(), u, v).position;
        const int link = rest.x() < 1 ? 0 : 1;
        const int half = rest.x() - link < 0.5 ? 0 : 1;
        const Vector3d want =
            frame.volume(rig_->volume(link, static_cast<VolumePart>(half)))
                .Position({2 * (rest.x() - link) - half, rest.y(), rest.z()});
        EXPECT_LE((EvaluateNurbs(deformed, u, v).position - want).norm(),
                  2 * tolerance);
      }
    }
  }
  EXPECT_GT(last_points, Tube(0.2).points.size());
}

// The volumes are C1: across their borders nets of any degree follow with the
// square of the knots' distance.
TEST_F(NurbsSkinTest, ErrorAtAnElbowFallsWithTheSquareOfTheSpacing) {
  NurbsSkinOptions as_it_is;
  as_it_is.tolerance_m = 1;
  double last_m = 0;
  for (int spans : {8, 16, 32, 64}) {
    const auto skin = NurbsSkin::Create(*rig_, Tube(0.2, spans), as_it_is);
    ASSERT_TRUE(skin.ok()) << skin.status();
    const double error_m = (*skin)->estimated_error_m();
    RecordProperty(absl::StrCat("error_", spans, "_spans"),
                   absl::StrCat(error_m));
    if (last_m > 0) {
      EXPECT_GT(last_m / error_m, 3) << spans;
    }
    last_m = error_m;
  }
}

TEST_F(NurbsSkinTest, TessellationIsTheSurface) {
  for (const NurbsSurface& surface : {Tube(0.2), Sphere(0.3)}) {
    const auto skin = Create(surface);
    const Eigen::VectorXd pose = ElbowAt(*arm_, 1.2);
    skin->Deform(pose, {}, workspace_, blocks_);
    const NurbsSurface deformed = skin->DeformedSurface(pose, {});
    const std::vector<Vector3d> positions = PositionsOf(*skin, blocks_);
    const std::vector<Vector3d> normals = NormalsOf(*skin, blocks_);
    for (int i = 0; i < skin->vertex_count(); ++i) {
      const Eigen::Vector2d at = skin->parameters(i);
      const NurbsPoint want = EvaluateNurbs(deformed, at[0], at[1]);
      EXPECT_LE((positions[i] - want.position).norm(), 3e-6);
      const Vector3d cross = want.along_u.cross(want.along_v);
      EXPECT_NEAR(normals[i].norm(), 1, 1e-5);
      // Poles have none.
      if (cross.norm() < 1e-9) continue;
      EXPECT_LE((normals[i] - cross.normalized()).norm(), 1e-3);
    }
  }
}

TEST_F(NurbsSkinTest, SphereIsClosedWithOneVertexAPole) {
  const auto skin = Create(Sphere(0.3));
  EXPECT_TRUE(IsClosed(skin->triangles()));
  skin->Deform(ElbowAt(*arm_, 0), {}, workspace_, blocks_);
  const std::vector<Vector3d> positions = PositionsOf(*skin, blocks_);
  const std::vector<Vector3d> normals = NormalsOf(*skin, blocks_);
  int poles = 0;
  const double orientation =
      EnclosedVolume(positions, skin->triangles()) > 0 ? 1 : -1;
  for (size_t i = 0; i < positions.size(); ++i) {
    const Vector3d out = (positions[i] - Vector3d(0.4, 0, 0)) / 0.3;
    EXPECT_NEAR(out.norm(), 1, 1e-5);
    EXPECT_LE((normals[i] - orientation * out).norm(), 1e-4);
    if (std::abs(out.x()) > 1 - 1e-6) ++poles;
  }
  EXPECT_EQ(poles, 2);
  // Chords are within the tolerance of the ball.
  const double ball = 4.0 / 3 * std::numbers::pi * 0.027;
  EXPECT_NEAR(std::abs(EnclosedVolume(positions, skin->triangles())) / ball, 1,
              0.02);
}

TEST_F(NurbsSkinTest, SeamStaysShut) {
  const auto skin = Create(Tube(0.2));
  const NurbsSurface deformed = skin->DeformedSurface(ElbowAt(*arm_, 1.5), {});
  const int last = deformed.u.count() - 1;
  for (int j = 0; j < deformed.v.count(); ++j) {
    EXPECT_LE((deformed.points[deformed.index(0, j)] -
               deformed.points[deformed.index(last, j)])
                  .norm(),
              1e-12);
  }
}

TEST_F(NurbsSkinTest, PointsThatDoNotDetermineTheNetAreRefused) {
  NurbsSurface open = Tube(0.2);
  for (size_t i = 0; i < open.v.knots.size(); ++i) open.v.knots[i] = i;
  EXPECT_THAT(NurbsSkin::Create(*rig_, open).status(),
              Fails(absl::StatusCode::kInvalidArgument, "v_knots"));
  NurbsSkinOptions options;
  options.tolerance_m = 0;
  EXPECT_FALSE(NurbsSkin::Create(*rig_, Tube(0.2), options).ok());
  options.tolerance_m = 1e-4;
  options.max_vertices = 50;
  EXPECT_THAT(NurbsSkin::Create(*rig_, Tube(0.2), options).status(),
              Fails(absl::StatusCode::kInvalidArgument, "vertices"));
}

// The net may not grow without end.
TEST_F(NurbsSkinTest, StopsAtTheMostPointsAndSaysSo) {
  NurbsSkinOptions options;
  options.tolerance_m = 1e-4;
  options.max_points = 100;
  options.max_vertices = 1 << 20;
  const auto skin = NurbsSkin::Create(*rig_, Tube(0.2), options).value();
  EXPECT_LE(skin->surface().points.size(), 100);
  EXPECT_GT(skin->estimated_error_m(), 1e-4);
}

}  // namespace
}  // namespace gelenk
