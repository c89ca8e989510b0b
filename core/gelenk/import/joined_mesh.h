// Meshes that are bound to one skeleton, joined into one.
//
// Each mesh comes with what moves its vertices while everything rests. It is
// put where that moves it, by the joint that has most of it; of each joint
// remains how it moves vertices against that, the identity where the bind pose
// is the rest pose. A joint can have only one such motion, so meshes that share
// joints are put where the ones before had theirs; where that does not fit,
// they cannot be joined.
#ifndef GELENK_IMPORT_JOINED_MESH_H_
#define GELENK_IMPORT_JOINED_MESH_H_

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "gelenk/import/gltf_mesh.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/skin/triangle_mesh.h"
#include "gelenk/skin/weighted_skin.h"

namespace gelenk {

// What moves the vertices of one mesh: a skin, or the joint that it hangs from.
struct MeshBinding {
  // Joints of the skeleton, by the places that influences name.
  std::vector<int> joints;
  // While everything rests, m; one a joint.
  std::vector<Eigen::Affine3d> skeleton_from_mesh;
  // Of what is at fault.
  std::string path;
};

// Nothing is left of volumes.
bool IsFlat(const Eigen::Affine3d& transform);

class JoinedMesh {
 public:
  // `skeleton` outlives this.
  explicit JoinedMesh(const Skeleton& skeleton)
      : skeleton_(skeleton), rest_from_bound_(skeleton.joint_count()) {}

  // Errors: INVALID_ARGUMENT with the binding's path: influences beyond its
  // joints, matrices that are flat or too large, a joint that a mesh before has
  // bound in another place. After one this is of no more use.
  absl::Status Append(const GltfMesh& mesh, const MeshBinding& binding);

  const TriangleMesh& mesh() const { return mesh_; }
  TriangleMesh TakeMesh() { return std::move(mesh_); }
  // Normalised; as many a vertex as any one needs.
  SkinWeights PackedWeights() const;
  // One a joint of the skeleton.
  std::vector<WeightedSkin::Affine> JointFromMesh() const;
  // Vertices without weight; they follow the first joint of their binding.
  int weightless_vertices() const { return weightless_; }

 private:
  // Where the vertices of a mesh go. `weights` are sums, one a joint.
  absl::StatusOr<Eigen::Affine3d> Place(
      const MeshBinding& binding, const std::vector<double>& weights) const;
  absl::Status Bind(const MeshBinding& binding,
                    const std::vector<double>& weights,
                    const Eigen::Affine3d& skeleton_from_mesh, double size_m);

  const Skeleton& skeleton_;
  TriangleMesh mesh_;
  // Per joint of the skeleton how it moves bound vertices in the rest pose;
  // nothing for one that no mesh has bound.
  std::vector<std::optional<Eigen::Affine3d>> rest_from_bound_;
  // By joints of the skeleton, for all vertices.
  std::vector<GltfInfluence> influences_;
  std::vector<size_t> influence_ends_;
  int weightless_ = 0;
};

}  // namespace gelenk

#endif  // GELENK_IMPORT_JOINED_MESH_H_
