// A mesh of a glTF file as the file says it: its primitives joined into one
// list of triangles, with the joints and weights of each vertex.
//
// Triangles, strips and fans; points and lines are left out. Texture
// coordinates, colours, materials and morph targets are not looked at.
#ifndef GELENK_IMPORT_GLTF_MESH_H_
#define GELENK_IMPORT_GLTF_MESH_H_

#include <nlohmann/json.hpp>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/import/gltf_accessor.h"
#include "gelenk/skin/triangle_mesh.h"

namespace gelenk {

struct GltfInfluence {
  // A place in the skin's list of joints.
  int joint = 0;
  // Finite, > 0; a vertex' weights have any sum.
  double weight = 0;
};

struct GltfMesh {
  // In the mesh's own frame, in the file's unit. There is a normal for every
  // vertex: where the file has none, the mean of the triangles around it.
  TriangleMesh surface;
  // Of all vertices, one after the other; at most eight each.
  std::vector<GltfInfluence> influences;
  // Per vertex the end of its influences; empty for a mesh that was read
  // without.
  std::vector<size_t> influence_ends;
  // Primitives left out: points and lines.
  int skipped_primitives = 0;
};

// Reads meshes[index]. `with_influences` is for a mesh that a skin moves: then
// every primitive must have JOINTS_0 and WEIGHTS_0, and may have a second set.
//
// Errors: INVALID_ARGUMENT with the path (`meshes[0].primitives[1].attributes
// .POSITION: ...`) for what is missing, out of range, not finite, of another
// type or count than the format says, compressed, or beyond `bounds`, which are
// checked before a number is read. Cost: linear.
absl::StatusOr<GltfMesh> ReadGltfMesh(const nlohmann::json& root, size_t index,
                                      bool with_influences,
                                      const MeshBounds& bounds,
                                      GltfAccessors& accessors);

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_MESH_H_
