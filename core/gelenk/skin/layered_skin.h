// A triangle mesh on the volumes of a rig: skeleton, muscles, skin.
//
// Vertices are sorted by their volumes once, into blocks of sixteen, and
// deformed by a kernel in single precision within 1e-6 of the size of the
// figure; the few near a branch, which several volumes share, follow by a
// kernel of their own. Normals are exact: those of the deformed surface.
#ifndef GELENK_SKIN_LAYERED_SKIN_H_
#define GELENK_SKIN_LAYERED_SKIN_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/skin/skin.h"
#include "gelenk/skin/skin_binding.h"
#include "gelenk/skin/triangle_mesh.h"
#include "gelenk/skin/volume_rig.h"

namespace gelenk {

class LayeredSkin : public Skin {
 public:
  // INVALID_ARGUMENT when the mesh is malformed or the binding is of another
  // mesh or rig. Cost: linear.
  static absl::StatusOr<std::shared_ptr<const LayeredSkin>> Create(
      std::shared_ptr<const VolumeRig> rig, const TriangleMesh& mesh,
      std::shared_ptr<const SkinBinding> binding);

  // Fits sections, binds, and creates: all in one.
  static absl::StatusOr<std::shared_ptr<const LayeredSkin>> Bind(
      const VolumeRig& rig, const TriangleMesh& mesh);

  const VolumeRig& rig() const { return *rig_; }
  const std::shared_ptr<const VolumeRig>& shared_rig() const { return rig_; }
  const SkinBinding& binding() const { return *binding_; }
  const TriangleMesh& mesh() const { return mesh_; }

  // The same skin on other muscles, with the same binding unless a fullness
  // changes a bent rest; then bound anew, assignments kept.
  absl::StatusOr<std::shared_ptr<const LayeredSkin>> WithMuscles(
      const SkinMuscles& muscles) const;

  void Deform(const ConstVectorView& positions,
              const RigidTransform& world_from_skeleton,
              SkinWorkspace& workspace, VertexBlocks& blocks) const override;

  void DeformQuantized(const ConstVectorView& positions,
                       const RigidTransform& world_from_skeleton,
                       SkinWorkspace& workspace,
                       QuantizedBlocks& blocks) const override;

  // The kernel alone, on volumes that are there already.
  void DeformIn(const VolumeFrame& frame, SkinWorkspace& workspace,
                VertexBlocks& blocks) const;
  void DeformQuantizedIn(const VolumeFrame& frame, SkinWorkspace& workspace,
                         QuantizedBlocks& blocks) const;  // in blocks.box

  // What the kernels work on, after Deform into `workspace`.
  kernel::DeformLayout LayoutIn(const SkinWorkspace& workspace) const;

  // In double precision, one by one: what the kernel is measured against, and
  // what wants no rounding. `normals` may be null.
  void DeformExactly(const VolumeFrame& frame,
                     std::vector<Eigen::Vector3d>& positions,
                     std::vector<Eigen::Vector3d>* normals) const;

  size_t ByteSize() const override;

  // A vertex that several volumes share, with two tangents at rest in the
  // coordinates of each, for the normal.
  struct SharedVertex {
    int vertex;
    int slot;
    int first_part;
    int part_count;
  };
  struct VolumeShare {
    int volume;
    VolumeCoordinates at;
    double share;
    // By the two tangents.
    Eigen::Vector3d coordinate_slopes[2];
    double share_slopes[2];
  };
  // By rising vertices; the last part of each is that of its own volume.
  absl::Span<const SharedVertex> shared_vertices() const { return shared_; }
  absl::Span<const VolumeShare> PartsOf(const SharedVertex& shared) const {
    return absl::MakeConstSpan(parts_).subspan(shared.first_part,
                                               shared.part_count);
  }

 private:
  struct Slots {
    std::vector<int> of_vertices;
    int block_count = 0;
    std::vector<kernel::VolumeRun> runs;
  };

  LayeredSkin(std::shared_ptr<const VolumeRig> rig, TriangleMesh mesh,
              std::shared_ptr<const SkinBinding> binding, Slots slots);

  static Slots SortByVolume(const VolumeRig& rig, const SkinBinding& binding);
  void FillBlocks();
  void AddShared(int vertex);
  void SortParts();
  void DeformShared(const SharedVertex& shared, const VolumeFrame& frame,
                    Eigen::Vector3d* position, Eigen::Vector3d* normal) const;
  // Runs that end at the ends of parts, and the first run of each part.
  struct PartRuns {
    std::vector<kernel::VolumeRun> runs;
    std::vector<int> first_runs;
  };
  static PartRuns CutRuns(absl::Span<const kernel::VolumeRun> runs,
                          int block_count);
  // Of blocks [first, end), which are whole parts.
  static kernel::DeformLayout LayoutOf(const PartRuns& cut, int first, int end,
                                       const SkinWorkspace& workspace,
                                       const float* vertices);
  // All parts by the kernel, then the sums of one vertex.
  void DeformParts(SkinWorkspace& workspace) const;
  // shared_[first] .. shared_[end - 1].
  void QuantizeShared(const SkinWorkspace& workspace, int first, int end,
                      QuantizedBlocks& blocks) const;
  void SumParts(const SharedVertex& shared, const SkinWorkspace& workspace,
                Eigen::Vector3f* position, Eigen::Vector3f* normal) const;
  void FillCoefficients(const VolumeFrame& frame,
                        SkinWorkspace& workspace) const;

  std::shared_ptr<const VolumeRig> rig_;
  TriangleMesh mesh_;
  std::shared_ptr<const SkinBinding> binding_;
  std::vector<Eigen::Vector3d> normals_;  // at rest
  PartRuns runs_;
  VertexBlocks vertices_;  // u, s, t and the normal's components
  std::vector<SharedVertex> shared_;
  std::vector<VolumeShare> parts_;
  PartRuns part_runs_;
  BlockRows part_rows_;  // parts_ sorted by volume, as kernel::kPartRows has it
  int part_block_count_ = 0;
  std::vector<int> part_offsets_;  // where the kernel's first sum of each is
};

}  // namespace gelenk

#endif  // GELENK_SKIN_LAYERED_SKIN_H_
