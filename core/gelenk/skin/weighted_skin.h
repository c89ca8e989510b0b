// Skins for characters that come with weights: linear blending and dual
// quaternions, and rigid pieces.
//
// Each vertex follows up to eight joints by weight. Linear blending
// is what every format and engine knows; it loses volume where a joint bends
// and collapses where it twists by half a turn. Dual quaternions keep the
// volume, and bulge on the outside of a bend. A rigid piece follows one joint.
//
// Source: Magnenat-Thalmann et al., "Joint-dependent local deformations", 1988;
// Kavan et al., "Skinning with dual quaternions", 2007.
#ifndef GELENK_SKIN_WEIGHTED_SKIN_H_
#define GELENK_SKIN_WEIGHTED_SKIN_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/skin/skin.h"
#include "gelenk/skin/triangle_mesh.h"

namespace gelenk {

inline constexpr int kMaxInfluences = 8;

struct SkinWeights {
  // 1 .. kMaxInfluences numbers of each vertex in `joints` and in `weights`.
  int influences_per_vertex = 4;
  // Indices of the skeleton's joints.
  std::vector<int> joints;
  // >= 0, in any sum > 0: they are normalised.
  std::vector<double> weights;
};

// All `vertex_count` vertices on one joint.
SkinWeights RigidWeights(int vertex_count, int joint);

enum class BlendMethod { kLinear, kDualQuaternion };

class WeightedSkin : public Skin {
 public:
  using Affine = Eigen::Matrix<double, 3, 4>;

  struct Options {
    BlendMethod method = BlendMethod::kLinear;
    // At which the mesh is bound; empty means the skeleton's rest pose.
    Eigen::VectorXd rest_positions;
    // One a joint ("inverse bind matrices"), or none: then those of the rest
    // pose. Dual quaternions need rigid ones.
    std::vector<Affine> joint_from_mesh;
    // Of a rigid piece the joint that it was made for, for who asks.
    int rigid_joint = -1;
  };

  // INVALID_ARGUMENT that lists what is wrong with mesh, weights or options.
  static absl::StatusOr<std::shared_ptr<const WeightedSkin>> Create(
      const std::shared_ptr<const Skeleton>& skeleton, const TriangleMesh& mesh,
      const SkinWeights& weights, const Options& options);

  BlendMethod method() const { return method_; }
  // -1 unless it is a rigid piece.
  int rigid_joint() const { return rigid_joint_; }

  void Deform(const ConstVectorView& positions,
              const RigidTransform& world_from_skeleton,
              SkinWorkspace& workspace, VertexBlocks& blocks) const override;

  size_t ByteSize() const override;

 private:
  WeightedSkin(const std::shared_ptr<const Skeleton>& skeleton,
               const TriangleMesh& mesh, const SkinWeights& weights,
               const Options& options);

  void BlendLinearly(const SkinWorkspace& workspace, int first_vertex,
                     int end_vertex, VertexBlocks& blocks) const;
  void BlendDualQuaternions(const SkinWorkspace& workspace, int first_vertex,
                            int end_vertex, VertexBlocks& blocks) const;

  BlendMethod method_;
  int influences_;
  int rigid_joint_;
  std::vector<int> joints_;
  std::vector<float> weights_;
  std::vector<Eigen::Vector3f> positions_;  // at rest
  std::vector<Eigen::Vector3f> normals_;
  std::vector<Affine> joint_from_mesh_;
};

// What was bound elsewhere, in the skeleton's rest pose: what a LayeredSkin is
// bound to. By linear blending; takes what WeightedSkin::Create takes.
TriangleMesh RestMesh(const Skeleton& skeleton, const TriangleMesh& mesh,
                      const SkinWeights& weights,
                      const WeightedSkin::Options& options);

}  // namespace gelenk

#endif  // GELENK_SKIN_WEIGHTED_SKIN_H_
