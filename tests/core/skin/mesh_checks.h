// What tests ask of meshes.
#ifndef GELENK_TESTS_CORE_SKIN_MESH_CHECKS_H_
#define GELENK_TESTS_CORE_SKIN_MESH_CHECKS_H_

#include <Eigen/Core>
#include <map>
#include <utility>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/skin/skin.h"
#include "gelenk/skin/triangle_mesh.h"
#include "gelenk/skin/vertex_blocks.h"

namespace gelenk::testing {

// Every edge has as many triangles on the one side as on the other.
inline bool IsClosed(absl::Span<const Triangle> triangles) {
  std::map<std::pair<int, int>, int> balance;
  for (const Triangle& triangle : triangles) {
    for (int k = 0; k < 3; ++k) {
      const int a = triangle[k], b = triangle[(k + 1) % 3];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  for (const auto& [edge, sum] : balance) {
    if (sum != 0) return false;
  }
  return true;
}

// The same triangles, each with corners of its own.
inline TriangleMesh TriangleSoup(const TriangleMesh& mesh) {
  TriangleMesh soup;
  for (const Triangle& triangle : mesh.triangles) {
    const int first = static_cast<int>(soup.positions.size());
    for (int corner : triangle) {
      soup.positions.push_back(mesh.positions[corner]);
    }
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

inline std::vector<Eigen::Vector3d> PositionsOf(const Skin& skin,
                                                const VertexBlocks& blocks) {
  std::vector<Eigen::Vector3d> positions;
  for (int slot : skin.slots()) {
    positions.push_back(blocks.position(slot).cast<double>());
  }
  return positions;
}

inline std::vector<Eigen::Vector3d> NormalsOf(const Skin& skin,
                                              const VertexBlocks& blocks) {
  std::vector<Eigen::Vector3d> normals;
  for (int slot : skin.slots()) {
    normals.push_back(blocks.normal(slot).cast<double>());
  }
  return normals;
}

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_CORE_SKIN_MESH_CHECKS_H_
