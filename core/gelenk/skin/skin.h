// A skin: a pose in, positions and normals of its vertices out.
//
// Immutable, shared as shared_ptr<const Skin>, safe to use from any thread with
// a workspace each. Deform allocates nothing once its workspace and its output
// have seen this skin.
#ifndef GELENK_SKIN_SKIN_H_
#define GELENK_SKIN_SKIN_H_

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/types/span.h"
#include "gelenk/base/parallel_for.h"
#include "gelenk/ik/instruction_set.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/skin/kernel/deform_layout.h"
#include "gelenk/skin/triangle_mesh.h"
#include "gelenk/skin/vertex_blocks.h"
#include "gelenk/skin/volume_rig.h"

namespace gelenk {

// Skins of fewer vertices are deformed on the calling thread: such a frame
// takes some 50 us, and waking other threads takes 10 us or more.
inline constexpr int kParallelVertices = 50000;
// Those of a part: what it reads and writes stays in a core's own cache, and
// runs for about as long as a thread takes to wake.
inline constexpr int kVerticesPerPart = 8192;
inline constexpr int kBlocksPerPart = kVerticesPerPart / kVerticesPerBlock;
// Of vertices that are deformed one by one, which takes ten times as long.
inline constexpr int kSingleVerticesPerPart = kVerticesPerPart / 8;

// What the kinds of skins work in, by kind; reuse it from frame to frame.
struct SkinWorkspace {
  // Runs the parts of skins of kParallelVertices or more; empty: one after the
  // other on the calling thread. The same bits either way.
  ParallelFor parallel_for;

  VolumeFrame frame;
  std::vector<kernel::VolumeCoefficients> coefficients;
  WorldTransforms world_from_joints;
  std::vector<Eigen::Matrix<float, 3, 4>> world_from_bind;
  std::vector<Eigen::Matrix<float, 8, 1>> dual_quaternions;
  std::vector<Eigen::Vector3d> vertices;
  Eigen::MatrixXd points;
  Eigen::MatrixXd fitted;
  Eigen::MatrixXd net;
  std::vector<float> rows;
  std::vector<float> sums;
  VertexBlocks blocks;
  BlockRows parts;
};

class Skin {
 public:
  virtual ~Skin() = default;
  Skin(const Skin&) = delete;
  Skin& operator=(const Skin&) = delete;

  const Skeleton& skeleton() const { return *skeleton_; }
  const std::shared_ptr<const Skeleton>& shared_skeleton() const {
    return skeleton_;
  }
  int vertex_count() const { return static_cast<int>(slots_.size()); }
  int block_count() const { return block_count_; }
  // Where each vertex is in the output.
  absl::Span<const int> slots() const { return slots_; }
  // Of vertices, not slots.
  absl::Span<const Triangle> triangles() const { return triangles_; }

  // `positions` has size position_count. Resizes `blocks`.
  virtual void Deform(const ConstVectorView& positions,
                      const RigidTransform& world_from_skeleton,
                      SkinWorkspace& workspace, VertexBlocks& blocks) const = 0;

  // The same as 8 bytes a vertex, within a box around the root that holds the
  // skin at every pose (of joints that turn; vertices that slide out of it end
  // on its wall).
  virtual void DeformQuantized(const ConstVectorView& positions,
                               const RigidTransform& world_from_skeleton,
                               SkinWorkspace& workspace,
                               QuantizedBlocks& blocks) const;

  // That box. Its size depends on the skin only.
  QuantizationBox BoxAt(const ConstVectorView& positions,
                        const RigidTransform& world_from_skeleton) const;

  // Bytes that this skin holds, for quotas.
  virtual size_t ByteSize() const;

 protected:
  // `rest_positions` of the vertices at pose `rest_pose` tell how far the skin
  // can reach.
  Skin(std::shared_ptr<const Skeleton> skeleton, std::vector<int> slots,
       int block_count, std::vector<Triangle> triangles,
       absl::Span<const Eigen::Vector3d> rest_positions,
       const Eigen::VectorXd& rest_pose);

  // Runs work(first, end) for parts of `part_size` items that cover
  // [0, count): in parallel when the skin is large and `workspace` can, else
  // all as one part.
  void ForParts(const SkinWorkspace& workspace, int count, int part_size,
                absl::FunctionRef<void(int first, int end)> work) const;

  // Those that this processor runs fastest.
  const kernel::DeformFunctions& functions() const { return *functions_; }

 private:
  std::shared_ptr<const Skeleton> skeleton_;
  std::vector<int> slots_;
  int block_count_ = 0;
  std::vector<Triangle> triangles_;
  double reach_m_ = 0;
  const kernel::DeformFunctions* functions_;
};

// Slots in the order of the vertices.
std::vector<int> SlotsInOrder(int vertex_count);

// Positions or normals in the order of the vertices: x y z each.
void GatherPositions(const Skin& skin, const VertexBlocks& blocks,
                     std::vector<float>& xyz);
void GatherNormals(const Skin& skin, const VertexBlocks& blocks,
                   std::vector<float>& xyz);

// `level` must be supported; see SupportedInstructionSets.
const kernel::DeformFunctions& DeformFunctionsFor(InstructionSet level);

kernel::QuantizationGrid GridOf(const QuantizationBox& box);

}  // namespace gelenk

#endif  // GELENK_SKIN_SKIN_H_
