// A triangle mesh at the rest pose, and what is derived from it.
//
// Skeleton frame (the actor stands at the origin), m. Triangles run
// counter-clockwise seen from outside.
#ifndef GELENK_SKIN_TRIANGLE_MESH_H_
#define GELENK_SKIN_TRIANGLE_MESH_H_

#include <Eigen/Core>
#include <vector>

#include "absl/status/status.h"
#include "absl/types/span.h"

namespace gelenk {

using Triangle = Eigen::Vector3i;  // indices of vertices

struct TriangleMesh {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Triangle> triangles;
  // One a vertex, any length but zero; or none, then they are the means of the
  // triangles around, by area.
  std::vector<Eigen::Vector3d> normals;
};

// A scanned body has half a million vertices, a game's character 50,000.
struct MeshBounds {
  int max_vertices = 1 << 20;
  int max_triangles = 1 << 21;
};

// Farther than that from the origin nothing is a body, and floats lose the
// micrometres.
inline constexpr double kMaxMeshCoordinateM = 1e3;

// INVALID_ARGUMENT that lists what is wrong: no vertices or too many, numbers
// that are not finite, indices out of range, as many normals as do not fit.
// Cost: linear.
absl::Status CheckMesh(const TriangleMesh& mesh, const MeshBounds& bounds = {});

// Unit normals: those of the mesh, or the means by area; +Z where there is
// none to tell.
std::vector<Eigen::Vector3d> VertexNormals(const TriangleMesh& mesh);

// Normals that are zero become such means; of a mesh with a normal a vertex.
// Exporters write zeros where they know none.
void FillMissingNormals(TriangleMesh& mesh);

// The volume inside a closed mesh, m^3; negative when it is inside out.
double EnclosedVolume(absl::Span<const Eigen::Vector3d> positions,
                      absl::Span<const Triangle> triangles);

// Vertices that share an edge: neighbours of v are
// neighbours[starts[v]] .. neighbours[starts[v + 1] - 1], each once, rising.
struct MeshEdges {
  std::vector<int> starts;
  std::vector<int> neighbours;

  absl::Span<const int> of(int vertex) const {
    return absl::MakeConstSpan(neighbours)
        .subspan(starts[vertex], starts[vertex + 1] - starts[vertex]);
  }
};
MeshEdges FindEdges(int vertex_count, absl::Span<const Triangle> triangles);

// The number of each vertex' connected component, from 0 in the order of their
// first vertices.
std::vector<int> FindComponents(const MeshEdges& edges);

}  // namespace gelenk

#endif  // GELENK_SKIN_TRIANGLE_MESH_H_
