#include "gelenk/skin/triangle_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

void CheckVectors(absl::Span<const Vector3d> vectors, absl::string_view field,
                  double most, Violations& violations) {
  for (size_t i = 0; i < vectors.size(); ++i) {
    // Written so that NaN fails.
    if (vectors[i].cwiseAbs().maxCoeff() <= most && vectors[i].allFinite()) {
      continue;
    }
    violations.Add(
        absl::StrCat(field, "[", i, "]"),
        absl::StrCat("want coordinates within ", most, ", got ", vectors[i].x(),
                     ", ", vectors[i].y(), ", ", vectors[i].z()));
  }
}

}  // namespace

absl::Status CheckMesh(const TriangleMesh& mesh, const MeshBounds& bounds) {
  Violations violations;
  const size_t vertices = mesh.positions.size();
  if (vertices == 0 || vertices > static_cast<size_t>(bounds.max_vertices)) {
    violations.Add("positions", absl::StrCat("want 1 to ", bounds.max_vertices,
                                             " vertices, got ", vertices));
  }
  if (mesh.triangles.size() > static_cast<size_t>(bounds.max_triangles)) {
    violations.Add("triangles",
                   absl::StrCat("want at most ", bounds.max_triangles, ", got ",
                                mesh.triangles.size()));
  }
  if (!mesh.normals.empty() && mesh.normals.size() != vertices) {
    violations.Add("normals", absl::StrCat("want none or ", vertices, ", got ",
                                           mesh.normals.size()));
  }
  // Too much of it is not looked at.
  if (!violations.empty()) return violations.ToStatus();
  CheckVectors(mesh.positions, "positions", kMaxMeshCoordinateM, violations);
  CheckVectors(mesh.normals, "normals", kMaxMeshCoordinateM, violations);
  for (size_t i = 0; i < mesh.normals.size(); ++i) {
    if (mesh.normals[i].isZero()) {
      violations.Add(absl::StrCat("normals[", i, "]"), "is zero");
    }
  }
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& triangle = mesh.triangles[i];
    if (triangle.minCoeff() >= 0 &&
        triangle.maxCoeff() < static_cast<int>(vertices)) {
      continue;
    }
    violations.Add(
        absl::StrCat("triangles[", i, "]"),
        absl::StrCat("want indices below ", vertices, ", got ", triangle[0],
                     ", ", triangle[1], ", ", triangle[2]));
  }
  return violations.ToStatus();
}

std::vector<Vector3d> VertexNormals(const TriangleMesh& mesh) {
  std::vector<Vector3d> normals = mesh.normals;
  if (normals.empty()) {
    normals.assign(mesh.positions.size(), Vector3d::Zero());
    for (const Triangle& triangle : mesh.triangles) {
      const Vector3d& a = mesh.positions[triangle[0]];
      const Vector3d twice_area = (mesh.positions[triangle[1]] - a)
                                      .cross(mesh.positions[triangle[2]] - a);
      for (int k = 0; k < 3; ++k) normals[triangle[k]] += twice_area;
    }
  }
  for (Vector3d& normal : normals) {
    // stableNormalized: slivers have tiny normals that count all the same.
    normal.stableNormalize();
    if (!(normal.squaredNorm() > 0.5)) normal = Vector3d::UnitZ();
  }
  return normals;
}

void FillMissingNormals(TriangleMesh& mesh) {
  const auto is_missing = [](const Vector3d& n) { return n.isZero(0); };
  if (std::none_of(mesh.normals.begin(), mesh.normals.end(), is_missing)) {
    return;
  }
  const std::vector<Vector3d> means =
      VertexNormals({mesh.positions, mesh.triangles, {}});
  for (size_t i = 0; i < means.size(); ++i) {
    if (is_missing(mesh.normals[i])) mesh.normals[i] = means[i];
  }
}

double EnclosedVolume(absl::Span<const Vector3d> positions,
                      absl::Span<const Triangle> triangles) {
  double six_volumes = 0;
  for (const Triangle& triangle : triangles) {
    six_volumes += positions[triangle[0]].dot(
        positions[triangle[1]].cross(positions[triangle[2]]));
  }
  return six_volumes / 6;
}

MeshEdges FindEdges(int vertex_count, absl::Span<const Triangle> triangles) {
  MeshEdges edges;
  edges.starts.assign(vertex_count + 1, 0);
  for (const Triangle& triangle : triangles) {
    for (int k = 0; k < 3; ++k) edges.starts[triangle[k] + 1] += 2;
  }
  for (int v = 0; v < vertex_count; ++v) {
    edges.starts[v + 1] += edges.starts[v];
  }
  std::vector<int> all(edges.starts.back());
  std::vector<int> next(edges.starts.begin(), edges.starts.end() - 1);
  for (const Triangle& triangle : triangles) {
    for (int k = 0; k < 3; ++k) {
      all[next[triangle[k]]++] = triangle[(k + 1) % 3];
      all[next[triangle[k]]++] = triangle[(k + 2) % 3];
    }
  }
  for (int v = 0; v < vertex_count; ++v) {
    const auto begin = all.begin() + edges.starts[v];
    const auto end = all.begin() + edges.starts[v + 1];
    std::sort(begin, end);
    edges.starts[v] = static_cast<int>(edges.neighbours.size());
    std::unique_copy(begin, end, std::back_inserter(edges.neighbours));
  }
  edges.starts[vertex_count] = static_cast<int>(edges.neighbours.size());
  return edges;
}

std::vector<int> FindComponents(const MeshEdges& edges) {
  const int count = static_cast<int>(edges.starts.size()) - 1;
  std::vector<int> components(count, -1);
  std::vector<int> open;
  int found = 0;
  for (int seed = 0; seed < count; ++seed) {
    if (components[seed] >= 0) continue;
    components[seed] = found;
    open.push_back(seed);
    while (!open.empty()) {
      const int vertex = open.back();
      open.pop_back();
      for (int neighbour : edges.of(vertex)) {
        if (components[neighbour] >= 0) continue;
        components[neighbour] = found;
        open.push_back(neighbour);
      }
    }
    ++found;
  }
  return components;
}

}  // namespace gelenk
