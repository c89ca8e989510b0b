#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "gelenk/skin/example_shapes.h"
#include "gelenk/skin/mesh_around.h"
#include "gelenk/skin/triangle_mesh.h"
#include "gelenk/skin/volume_rig.h"
#include "tests/core/skin/mesh_checks.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::Fails;
using ::gelenk::testing::IsClosed;
using ::testing::ElementsAre;

TEST(TubeMeshTest, IsClosedAndAsLargeAsItSays) {
  TubeShape shape;
  shape.length_m = 2;
  shape.radius_m = 0.3;
  shape.around = 100;
  const TriangleMesh mesh = TubeMesh(shape).value();
  EXPECT_TRUE(IsClosed(mesh.triangles));
  const double polygon = 50 * 0.09 * std::sin(2 * std::numbers::pi / 100);
  EXPECT_NEAR(EnclosedVolume(mesh.positions, mesh.triangles), 2 * polygon,
              1e-12);
}

TEST(TubeMeshTest, NormalsPointOutwards) {
  TubeShape shape;
  const TriangleMesh mesh = TubeMesh(shape).value();
  const std::vector<Vector3d> normals = VertexNormals(mesh);
  for (size_t v = 0; v < normals.size(); ++v) {
    EXPECT_NEAR(normals[v].norm(), 1, 1e-12);
    EXPECT_GE(normals[v].dot(mesh.positions[v] -
                             Vector3d(0.5 * shape.length_m, 0, 0)),
              0);
  }
}

TEST(TubeMeshTest, AbsurdShapesAreRefused) {
  for (auto [rings, around] : {std::pair(0, 24), {10, 2}, {1 << 30, 24}}) {
    TubeShape shape;
    shape.rings = rings;
    shape.around = around;
    EXPECT_FALSE(TubeMesh(shape).ok());
  }
  TubeShape shape;
  shape.radius_m = std::nan("");
  EXPECT_THAT(TubeMesh(shape).status(),
              Fails(absl::StatusCode::kInvalidArgument, "radius"));
}

TEST(MeshAroundTest, SphereHasItsVolumeAndNormals) {
  const Capsule ball = {{1, 2, 3}, {1, 2, 3}, 0.5, 0.5};
  const TriangleMesh mesh = MeshAround({ball}, 0.02, 0).value();
  EXPECT_TRUE(IsClosed(mesh.triangles));
  // A polyhedron with corners on the sphere: less by about (cell / r)^2.
  EXPECT_NEAR(EnclosedVolume(mesh.positions, mesh.triangles),
              4.0 / 3 * std::numbers::pi * 0.125, 1e-3);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vector3d out = mesh.positions[v] - ball.start;
    EXPECT_NEAR(out.norm(), 0.5, 1e-9);
    EXPECT_LE((mesh.normals[v] - out.normalized()).norm(), 1e-5);
  }
}

TEST(MeshAroundTest, RefusesWhatItCannotMesh) {
  const Capsule good = {{0, 0, 0}, {1, 0, 0}, 0.1, 0.1};
  const auto code = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(MeshAround({}, 0.1, 0).status(), Fails(code, "capsules"));
  EXPECT_THAT(MeshAround({good}, 0, 0).status(), Fails(code, "cell"));
  EXPECT_THAT(MeshAround({good}, 1e-5, 0).status(), Fails(code, "cells"));
  Capsule bad = good;
  bad.end.x() = std::nan("");
  EXPECT_THAT(MeshAround({good, bad}, 0.1, 0).status(),
              Fails(code, "capsules[1]"));
}

TEST(MeshEdgesTest, NeighboursAreEachOther) {
  const MeshEdges edges = FindEdges(5, {Triangle(0, 1, 2), Triangle(2, 1, 3)});
  EXPECT_THAT(edges.of(1), ElementsAre(0, 2, 3));
  EXPECT_THAT(edges.of(3), ElementsAre(1, 2));
  EXPECT_TRUE(edges.of(4).empty());
  EXPECT_THAT(FindComponents(edges), ElementsAre(0, 0, 0, 0, 1));
}

TEST(ExampleShapesTest, AreClosedBodiesAboutAsFineAsAsked) {
  for (absl::string_view name : SkinShapeNames()) {
    for (int wanted : {1000, 10000}) {
      const SkinShape shape = MakeSkinShape(name, wanted).value();
      EXPECT_TRUE(IsClosed(shape.mesh.triangles)) << name;
      EXPECT_TRUE(CheckMesh(shape.mesh).ok());
      EXPECT_GT(EnclosedVolume(shape.mesh.positions, shape.mesh.triangles), 0);
      const int count = static_cast<int>(shape.mesh.positions.size());
      EXPECT_GT(count, 0.9 * wanted) << name;
      EXPECT_LT(count, 1.1 * wanted) << name;
      EXPECT_EQ(static_cast<int>(shape.joint_ids.size()), count);
      const auto rig =
          VolumeRig::Create(shape.skeleton, shape.links, shape.muscles);
      ASSERT_TRUE(rig.ok()) << rig.status();
      for (const std::string& id : shape.joint_ids) {
        ASSERT_GE((*rig)->FindLink(id), 0) << id;
      }
      const MeshEdges edges = FindEdges(count, shape.mesh.triangles);
      const std::vector<int> components = FindComponents(edges);
      EXPECT_EQ(*std::max_element(components.begin(), components.end()), 0)
          << name;
    }
  }
}

TEST(ExampleShapesTest, HumanoidStandsUpright) {
  const SkinShape shape = MakeSkinShape("humanoid").value();
  double low = 10, high = 0;
  for (const Vector3d& p : shape.mesh.positions) {
    low = std::min(low, p.y());
    high = std::max(high, p.y());
  }
  EXPECT_NEAR(low, 0, 0.01);
  EXPECT_NEAR(high, 1.75, 0.02);
}

TEST(ExampleShapesTest, OthersAreRefused) {
  EXPECT_THAT(MakeSkinShape("horse").status(),
              Fails(absl::StatusCode::kNotFound, "humanoid"));
  for (int count : {99, 100001, -1}) {
    EXPECT_THAT(MakeSkinShape("arm", count).status(),
                Fails(absl::StatusCode::kInvalidArgument, "want 100 to"));
  }
  EXPECT_TRUE(MakeSkinShape("arm", 100).ok());
}

}  // namespace
}  // namespace gelenk
