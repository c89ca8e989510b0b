#include "gelenk/skin/skin.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace gelenk {
namespace {

using Eigen::Vector3d;

// Muscles and bends push vertices out a little farther than any rigid pose.
constexpr double kSwelling = 1.25;
// A skin without extent still has a box.
constexpr double kLeastReachM = 1e-3;

// How far from the root's origin a vertex can come: along the joints to the
// nearest of them, and on to the vertex.
double Reach(const Skeleton& skeleton, absl::Span<const Vector3d> vertices,
             const Eigen::VectorXd& rest_pose) {
  WorldTransforms world_from_joints;
  ForwardKinematics(skeleton, rest_pose, world_from_joints);
  std::vector<double> path(skeleton.joint_count(), 0);
  for (int i = 1; i < skeleton.joint_count(); ++i) {
    const int parent = skeleton.span(i).parent;
    path[i] = path[parent] + (world_from_joints[i].translation -
                              world_from_joints[parent].translation)
                                 .norm();
  }
  double reach = kLeastReachM;
  for (const Vector3d& vertex : vertices) {
    double nearest = (vertex - world_from_joints[0].translation).norm();
    double by_path = nearest;
    for (int i = 1; i < skeleton.joint_count(); ++i) {
      const double distance =
          (vertex - world_from_joints[i].translation).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      by_path = path[i] + distance;
    }
    reach = std::max(reach, by_path);
  }
  return kSwelling * reach;
}

void Gather(const Skin& skin, const VertexBlocks& blocks,
            Eigen::Vector3f (VertexBlocks::*row)(int) const,
            std::vector<float>& xyz) {
  xyz.resize(3 * static_cast<size_t>(skin.vertex_count()));
  for (int v = 0; v < skin.vertex_count(); ++v) {
    Eigen::Map<Eigen::Vector3f>(xyz.data() + 3 * static_cast<size_t>(v)) =
        (blocks.*row)(skin.slots()[v]);
  }
}

}  // namespace

Skin::Skin(std::shared_ptr<const Skeleton> skeleton, std::vector<int> slots,
           int block_count, std::vector<Triangle> triangles,
           absl::Span<const Vector3d> rest_positions,
           const Eigen::VectorXd& rest_pose)
    : skeleton_(std::move(skeleton)),
      slots_(std::move(slots)),
      block_count_(block_count),
      triangles_(std::move(triangles)),
      reach_m_(Reach(*skeleton_, rest_positions, rest_pose)),
      functions_(&DeformFunctionsFor(BestInstructionSet())) {}

void Skin::DeformQuantized(const ConstVectorView& positions,
                           const RigidTransform& world_from_skeleton,
                           SkinWorkspace& workspace,
                           QuantizedBlocks& blocks) const {
  Deform(positions, world_from_skeleton, workspace, workspace.blocks);
  blocks.Resize(block_count_);
  blocks.box = BoxAt(positions, world_from_skeleton);
  const kernel::QuantizationGrid grid = GridOf(blocks.box);
  ForParts(workspace, block_count_, kBlocksPerPart, [&](int first, int end) {
    functions_->quantize(
        workspace.blocks.data() + int64_t{kernel::kBlockFloats} * first,
        end - first, grid,
        blocks.data() + int64_t{kernel::kQuantizedBlockBytes} * first);
  });
}

void Skin::ForParts(const SkinWorkspace& workspace, int count, int part_size,
                    absl::FunctionRef<void(int first, int end)> work) const {
  if (!workspace.parallel_for || vertex_count() < kParallelVertices ||
      count <= part_size) {
    work(0, count);
    return;
  }
  workspace.parallel_for((count + part_size - 1) / part_size, [&](int part) {
    work(part * part_size, std::min((part + 1) * part_size, count));
  });
}

QuantizationBox Skin::BoxAt(const ConstVectorView& positions,
                            const RigidTransform& world_from_skeleton) const {
  const RigidTransform world_from_root = world_from_skeleton *
                                         skeleton_->joint(0).parent_from_joint *
                                         JointMotion(*skeleton_, 0, positions);
  return {world_from_root.translation - Vector3d::Constant(reach_m_),
          2 * reach_m_};
}

size_t Skin::ByteSize() const {
  return sizeof(*this) + slots_.size() * sizeof(int) +
         triangles_.size() * sizeof(Triangle);
}

std::vector<int> SlotsInOrder(int vertex_count) {
  std::vector<int> slots(vertex_count);
  std::iota(slots.begin(), slots.end(), 0);
  return slots;
}

void GatherPositions(const Skin& skin, const VertexBlocks& blocks,
                     std::vector<float>& xyz) {
  Gather(skin, blocks, &VertexBlocks::position, xyz);
}

void GatherNormals(const Skin& skin, const VertexBlocks& blocks,
                   std::vector<float>& xyz) {
  Gather(skin, blocks, &VertexBlocks::normal, xyz);
}

const kernel::DeformFunctions& DeformFunctionsFor(
    [[maybe_unused]] InstructionSet level) {
#ifdef GELENK_X86_LEVELS
  if (level == InstructionSet::kAvx2) return kernel::avx2::kDeform;
  if (level == InstructionSet::kAvx512) return kernel::avx512::kDeform;
#endif
  return kernel::baseline::kDeform;
}

kernel::QuantizationGrid GridOf(const QuantizationBox& box) {
  return {
      {static_cast<float>(box.origin.x()), static_cast<float>(box.origin.y()),
       static_cast<float>(box.origin.z())},
      static_cast<float>(65535 / box.size_m)};
}

}  // namespace gelenk
