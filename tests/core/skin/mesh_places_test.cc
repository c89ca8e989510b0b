#include "gelenk/skin/mesh_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "gelenk/skin/mesh_around.h"
#include "tests/core/skin/mesh_checks.h"
#include "tests/testing/random.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::TriangleSoup;
using ::testing::Each;
using ::testing::ElementsAre;

TEST(MeshPlacesTest, NamesTheFirstVertexOfEachPlace) {
  const std::vector<Vector3d> positions = {
      {0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {1, 1e-9, 0}, {1, 1e-3, 0}, {-0.0, 0, 0},
  };
  EXPECT_THAT(FindPlaces(positions), ElementsAre(0, 1, 0, 1, 4, 0));
  EXPECT_TRUE(FindPlaces({}).empty());
  EXPECT_THAT(FindPlaces({{2, 2, 2}, {2, 2, 2}}), Each(0));
}

// Whichever cell of the grid a point is in, and its twin.
TEST(MeshPlacesTest, TwinsMeetAcrossTheBordersOfCells) {
  testing::Random random(7);
  std::vector<Vector3d> positions = {{-1, -1, -1}, {1, 1, 1}};
  const double half_m = 0.5 * kPlaceTolerance;
  for (int i = 0; i < 5000; ++i) {
    const Vector3d point = testing::RandomVector(random, 0.9);
    positions.push_back(point);
    positions.push_back(point + testing::RandomVector(random, half_m));
  }
  const std::vector<int> places = FindPlaces(positions);
  for (size_t v = 2; v < positions.size(); v += 2) {
    EXPECT_EQ(places[v], static_cast<int>(v));
    EXPECT_EQ(places[v + 1], static_cast<int>(v));
  }
}

// Two tubes apart, written as triangles that share no vertex.
TEST(MeshPlacesTest, ASoupHangsTogetherAsItsMeshDoes) {
  TriangleMesh mesh = TubeMesh({1, 0.1, 4, 6}).value();
  const int first = static_cast<int>(mesh.positions.size());
  const TriangleMesh tube = mesh;
  for (const Vector3d& position : tube.positions) {
    mesh.positions.push_back(position + Vector3d::UnitZ());
  }
  for (const Triangle& triangle : tube.triangles) {
    mesh.triangles.push_back(triangle.array() + first);
  }
  const TriangleMesh soup = TriangleSoup(mesh);
  const std::vector<int> places = FindPlaces(soup.positions);
  const std::vector<int> components =
      FindComponentsOfPlaces(soup.triangles, places);
  for (size_t i = 0; i < soup.triangles.size(); ++i) {
    const int want = i < tube.triangles.size() ? 0 : 1;
    for (int corner : soup.triangles[i]) EXPECT_EQ(components[corner], want);
  }
  const MeshEdges of_mesh = FindEdges(2 * first, mesh.triangles);
  const MeshEdges of_soup = FindEdgesOfPlaces(soup.triangles, places);
  EXPECT_EQ(of_soup.neighbours.size(), of_mesh.neighbours.size());
}

}  // namespace
}  // namespace gelenk
