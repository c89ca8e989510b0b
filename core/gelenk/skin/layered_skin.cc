#include "gelenk/skin/layered_skin.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cstdint>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/skin/section_fit.h"

namespace gelenk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

absl::Status CheckBinding(const VolumeRig& rig, const TriangleMesh& mesh,
                          const SkinBinding& binding) {
  if (binding.vertices.size() != mesh.positions.size()) {
    return absl::InvalidArgumentError(
        absl::StrCat("binding: is of ", binding.vertices.size(),
                     " vertices, the mesh has ", mesh.positions.size()));
  }
  for (size_t v = 0; v < binding.vertices.size(); ++v) {
    const VertexBinding& vertex = binding.vertices[v];
    bool fits = vertex.volume >= 0 && vertex.volume < rig.volume_count() &&
                vertex.first_share >= 0 && vertex.share_count >= 0 &&
                vertex.first_share + vertex.share_count <=
                    static_cast<int>(binding.shares.size());
    if (fits) {
      for (const BlendShare& share : binding.SharesOf(static_cast<int>(v))) {
        fits = fits && share.volume >= 0 && share.volume < rig.volume_count();
      }
    }
    if (!fits) {
      return absl::InvalidArgumentError(absl::StrCat(
          "binding.vertices[", v, "]: refers to what the rig does not have"));
    }
  }
  return absl::OkStatus();
}

// Whole blocks for `counts` of each volume, which become the first slots.
std::vector<kernel::VolumeRun> RunsOf(std::vector<int>& counts,
                                      int* block_count) {
  std::vector<kernel::VolumeRun> runs;
  *block_count = 0;
  for (size_t volume = 0; volume < counts.size(); ++volume) {
    const int blocks = BlocksFor(counts[volume]);
    counts[volume] = *block_count * kVerticesPerBlock;
    if (blocks == 0) continue;
    runs.push_back(
        {static_cast<int>(volume), *block_count, *block_count + blocks});
    *block_count += blocks;
  }
  return runs;
}

bool HaveSameRest(const VolumeRig& a, const VolumeRig& b) {
  return std::equal(a.rest().all_planes().begin(), a.rest().all_planes().end(),
                    b.rest().all_planes().begin(), b.rest().all_planes().end(),
                    [](const ControlPlane& p, const ControlPlane& q) {
                      return p.columns == q.columns;
                    });
}

}  // namespace

absl::StatusOr<std::shared_ptr<const LayeredSkin>> LayeredSkin::Create(
    std::shared_ptr<const VolumeRig> rig, const TriangleMesh& mesh,
    std::shared_ptr<const SkinBinding> binding) {
  if (absl::Status status = CheckMesh(mesh); !status.ok()) return status;
  if (absl::Status status = CheckBinding(*rig, mesh, *binding); !status.ok()) {
    return status;
  }
  Slots slots = SortByVolume(*rig, *binding);
  return std::shared_ptr<const LayeredSkin>(new LayeredSkin(
      std::move(rig), mesh, std::move(binding), std::move(slots)));
}

absl::StatusOr<std::shared_ptr<const LayeredSkin>> LayeredSkin::Bind(
    const VolumeRig& rig, const TriangleMesh& mesh) {
  if (absl::Status status = CheckMesh(mesh); !status.ok()) return status;
  std::shared_ptr<const VolumeRig> fitted = FitSections(rig, mesh);
  absl::StatusOr<SkinBinding> binding = BindMesh(*fitted, mesh);
  if (!binding.ok()) return binding.status();
  return Create(std::move(fitted), mesh,
                std::make_shared<const SkinBinding>(*std::move(binding)));
}

absl::StatusOr<std::shared_ptr<const LayeredSkin>> LayeredSkin::WithMuscles(
    const SkinMuscles& muscles) const {
  absl::StatusOr<std::shared_ptr<const VolumeRig>> rig =
      rig_->WithMuscles(muscles);
  if (!rig.ok()) return rig.status();
  if (HaveSameRest(*rig_, **rig)) return Create(*rig, mesh_, binding_);
  // A mitre changes the volumes of a bent rest: bind again.
  absl::StatusOr<SkinBinding> binding =
      BindMesh(**rig, mesh_, binding_->assignments);
  if (!binding.ok()) return binding.status();
  return Create(*std::move(rig), mesh_,
                std::make_shared<const SkinBinding>(*std::move(binding)));
}

LayeredSkin::LayeredSkin(std::shared_ptr<const VolumeRig> rig,
                         TriangleMesh mesh,
                         std::shared_ptr<const SkinBinding> binding,
                         Slots slots)
    : Skin(rig->shared_skeleton(), std::move(slots.of_vertices),
           slots.block_count, mesh.triangles, mesh.positions,
           rig->rest_positions()),
      rig_(std::move(rig)),
      mesh_(std::move(mesh)),
      binding_(std::move(binding)),
      normals_(VertexNormals(mesh_)),
      runs_(CutRuns(slots.runs, block_count())) {
  FillBlocks();
}

LayeredSkin::Slots LayeredSkin::SortByVolume(const VolumeRig& rig,
                                             const SkinBinding& binding) {
  std::vector<int> next(rig.volume_count(), 0);
  for (const VertexBinding& vertex : binding.vertices) ++next[vertex.volume];
  Slots slots;
  slots.runs = RunsOf(next, &slots.block_count);
  for (const VertexBinding& vertex : binding.vertices) {
    slots.of_vertices.push_back(next[vertex.volume]++);
  }
  return slots;
}

void LayeredSkin::FillBlocks() {
  vertices_.Resize(block_count());
  // Padding: a point of the volume, with a normal.
  for (int slot = 0; slot < block_count() * kVerticesPerBlock; ++slot) {
    vertices_.Set(slot, Eigen::Vector3f::Zero(), Eigen::Vector3f::UnitY());
  }
  for (int v = 0; v < vertex_count(); ++v) {
    const VertexBinding& vertex = binding_->vertices[v];
    const Matrix3d jacobian =
        rig_->rest().volume(vertex.volume).Evaluate(vertex.at).Jacobian();
    const Vector3d normal = jacobian.transpose() * normals_[v];
    vertices_.Set(slots()[v],
                  Vector3d(vertex.at.u, vertex.at.s, vertex.at.t).cast<float>(),
                  normal.cast<float>());
    if (vertex.share_count > 0) AddShared(v);
  }
  SortParts();
}

void LayeredSkin::SortParts() {
  std::vector<int> next(rig_->volume_count(), 0);
  for (const VolumeShare& part : parts_) ++next[part.volume];
  const std::vector<kernel::VolumeRun> runs = RunsOf(next, &part_block_count_);
  part_runs_ = CutRuns(runs, part_block_count_);
  part_rows_.Resize(part_block_count_, kernel::kPartRows);
  for (const VolumeShare& part : parts_) {
    const int slot = next[part.volume]++;
    part_offsets_.push_back(slot / kVerticesPerBlock * kernel::kPartSumRows *
                                kVerticesPerBlock +
                            slot % kVerticesPerBlock);
    const double numbers[kernel::kPartRows] = {part.at.u,
                                               part.at.s,
                                               part.at.t,
                                               part.coordinate_slopes[0][0],
                                               part.coordinate_slopes[0][1],
                                               part.coordinate_slopes[0][2],
                                               part.coordinate_slopes[1][0],
                                               part.coordinate_slopes[1][1],
                                               part.coordinate_slopes[1][2],
                                               part.share,
                                               part.share_slopes[0],
                                               part.share_slopes[1]};
    for (int row = 0; row < kernel::kPartRows; ++row) {
      part_rows_.at(slot, row) = static_cast<float>(numbers[row]);
    }
  }
}

void LayeredSkin::AddShared(int v) {
  const VertexBinding& vertex = binding_->vertices[v];
  shared_.push_back(
      {v, slots()[v], static_cast<int>(parts_.size()), vertex.share_count + 1});
  const Vector3d tangents[2] = {
      normals_[v].unitOrthogonal(),
      normals_[v].cross(normals_[v].unitOrthogonal())};
  const auto add = [&](int volume, const VolumeCoordinates& at, double share,
                       const Vector3d& gradient) {
    const Matrix3d coordinates_from_point =
        rig_->rest().volume(volume).Evaluate(at).Jacobian().inverse();
    VolumeShare part = {volume, at, share, {}, {}};
    for (int k = 0; k < 2; ++k) {
      part.coordinate_slopes[k] = coordinates_from_point * tangents[k];
      part.share_slopes[k] = gradient.dot(tangents[k]);
    }
    parts_.push_back(part);
  };
  double rest = 1;
  Vector3d rest_gradient = Vector3d::Zero();
  for (const BlendShare& share : binding_->SharesOf(v)) {
    add(share.volume, share.at, share.share, share.gradient);
    rest -= share.share;
    rest_gradient -= share.gradient;
  }
  add(vertex.volume, vertex.at, rest, rest_gradient);
}

void LayeredSkin::DeformShared(const SharedVertex& shared,
                               const VolumeFrame& frame, Vector3d* position,
                               Vector3d* normal) const {
  *position = Vector3d::Zero();
  Vector3d tangents[2] = {Vector3d::Zero(), Vector3d::Zero()};
  for (int i = 0; i < shared.part_count; ++i) {
    const VolumeShare& part = parts_[shared.first_part + i];
    const VolumePoint point = frame.volume(part.volume).Evaluate(part.at);
    *position += part.share * point.position;
    for (int k = 0; k < 2; ++k) {
      tangents[k] +=
          part.share * (point.Jacobian() * part.coordinate_slopes[k]) +
          part.share_slopes[k] * point.position;
    }
  }
  *normal = tangents[0].cross(tangents[1]).normalized();
}

LayeredSkin::PartRuns LayeredSkin::CutRuns(
    absl::Span<const kernel::VolumeRun> runs, int block_count) {
  PartRuns cut;
  for (const kernel::VolumeRun& run : runs) {
    for (int block = run.first_block; block < run.end_block;) {
      const int end = std::min(run.end_block,
                               (block / kBlocksPerPart + 1) * kBlocksPerPart);
      if (block % kBlocksPerPart == 0) {
        cut.first_runs.push_back(static_cast<int>(cut.runs.size()));
      }
      cut.runs.push_back({run.volume, block, end});
      block = end;
    }
  }
  cut.first_runs.resize((block_count + kBlocksPerPart - 1) / kBlocksPerPart + 1,
                        static_cast<int>(cut.runs.size()));
  return cut;
}

kernel::DeformLayout LayeredSkin::LayoutOf(const PartRuns& cut, int first,
                                           int end,
                                           const SkinWorkspace& workspace,
                                           const float* vertices) {
  const int first_run = cut.first_runs[first / kBlocksPerPart];
  const int end_run =
      cut.first_runs[(end + kBlocksPerPart - 1) / kBlocksPerPart];
  return {workspace.coefficients.data(), cut.runs.data() + first_run,
          end_run - first_run, vertices};
}

void LayeredSkin::DeformParts(SkinWorkspace& workspace) const {
  if (shared_.empty()) return;
  workspace.parts.Resize(part_block_count_, kernel::kPartSumRows);
  ForParts(workspace, part_block_count_, kBlocksPerPart,
           [&](int first, int end) {
             functions().deform_parts(
                 LayoutOf(part_runs_, first, end, workspace, part_rows_.data()),
                 workspace.parts.data());
           });
}

void LayeredSkin::SumParts(const SharedVertex& shared,
                           const SkinWorkspace& workspace,
                           Eigen::Vector3f* position,
                           Eigen::Vector3f* normal) const {
  Eigen::Matrix3f sum = Eigen::Matrix3f::Zero();
  for (int i = 0; i < shared.part_count; ++i) {
    const float* from =
        workspace.parts.data() + part_offsets_[shared.first_part + i];
    for (int row = 0; row < kernel::kPartSumRows; ++row) {
      sum.data()[row] += from[row * kVerticesPerBlock];
    }
  }
  *position = sum.col(0);
  *normal = sum.col(1).cross(sum.col(2)).normalized();
}

void LayeredSkin::FillCoefficients(const VolumeFrame& frame,
                                   SkinWorkspace& workspace) const {
  workspace.coefficients.resize(rig_->volume_count());
  for (int volume = 0; volume < rig_->volume_count(); ++volume) {
    for (int power = 0; power < 4; ++power) {
      const Matrix3d& columns = frame.volume(volume).coefficient(power);
      float* to = workspace.coefficients[volume].powers[power];
      for (int i = 0; i < 9; ++i) {
        to[i] = static_cast<float>(columns.data()[i]);
      }
    }
  }
}

kernel::DeformLayout LayeredSkin::LayoutIn(
    const SkinWorkspace& workspace) const {
  return LayoutOf(runs_, 0, block_count(), workspace, vertices_.data());
}

void LayeredSkin::Deform(const ConstVectorView& positions,
                         const RigidTransform& world_from_skeleton,
                         SkinWorkspace& workspace, VertexBlocks& blocks) const {
  rig_->Evaluate(positions, world_from_skeleton, workspace.frame);
  DeformIn(workspace.frame, workspace, blocks);
}

void LayeredSkin::DeformIn(const VolumeFrame& frame, SkinWorkspace& workspace,
                           VertexBlocks& blocks) const {
  FillCoefficients(frame, workspace);
  blocks.Resize(block_count());
  ForParts(workspace, block_count(), kBlocksPerPart, [&](int first, int end) {
    functions().deform(LayoutOf(runs_, first, end, workspace, vertices_.data()),
                       blocks.data());
  });
  DeformParts(workspace);
  ForParts(workspace, static_cast<int>(shared_.size()), kSingleVerticesPerPart,
           [&](int first, int end) {
             for (int i = first; i < end; ++i) {
               Eigen::Vector3f position, normal;
               SumParts(shared_[i], workspace, &position, &normal);
               blocks.Set(shared_[i].slot, position, normal);
             }
           });
}

void LayeredSkin::DeformQuantized(const ConstVectorView& positions,
                                  const RigidTransform& world_from_skeleton,
                                  SkinWorkspace& workspace,
                                  QuantizedBlocks& blocks) const {
  rig_->Evaluate(positions, world_from_skeleton, workspace.frame);
  blocks.box = BoxAt(positions, world_from_skeleton);
  DeformQuantizedIn(workspace.frame, workspace, blocks);
}

void LayeredSkin::DeformQuantizedIn(const VolumeFrame& frame,
                                    SkinWorkspace& workspace,
                                    QuantizedBlocks& blocks) const {
  FillCoefficients(frame, workspace);
  blocks.Resize(block_count());
  const kernel::QuantizationGrid grid = GridOf(blocks.box);
  ForParts(workspace, block_count(), kBlocksPerPart, [&](int first, int end) {
    functions().deform_quantized(
        LayoutOf(runs_, first, end, workspace, vertices_.data()), grid,
        blocks.data());
  });
  DeformParts(workspace);
  ForParts(workspace, static_cast<int>(shared_.size()), kSingleVerticesPerPart,
           [&](int first, int end) {
             QuantizeShared(workspace, first, end, blocks);
           });
}

// Sixteen at a time, and each to its place.
void LayeredSkin::QuantizeShared(const SkinWorkspace& workspace, int first,
                                 int end, QuantizedBlocks& blocks) const {
  const kernel::QuantizationGrid grid = GridOf(blocks.box);
  alignas(64) float floats[kernel::kBlockFloats] = {};
  alignas(64) uint8_t bytes[kernel::kQuantizedBlockBytes];
  for (int at = first; at < end; at += kVerticesPerBlock) {
    const int count = std::min(kVerticesPerBlock, end - at);
    for (int lane = 0; lane < count; ++lane) {
      Eigen::Vector3f position, normal;
      SumParts(shared_[at + lane], workspace, &position, &normal);
      for (int k = 0; k < 3; ++k) {
        floats[k * kVerticesPerBlock + lane] = position[k];
        floats[(3 + k) * kVerticesPerBlock + lane] = normal[k];
      }
    }
    functions().quantize(floats, 1, grid, bytes);
    for (int lane = 0; lane < count; ++lane) {
      blocks.SetSlot(bytes, lane, shared_[at + lane].slot);
    }
  }
}

void LayeredSkin::DeformExactly(const VolumeFrame& frame,
                                std::vector<Vector3d>& positions,
                                std::vector<Vector3d>* normals) const {
  positions.resize(vertex_count());
  if (normals) normals->resize(vertex_count());
  for (int v = 0; v < vertex_count(); ++v) {
    const VertexBinding& vertex = binding_->vertices[v];
    const VolumePoint point = frame.volume(vertex.volume).Evaluate(vertex.at);
    positions[v] = point.position;
    if (normals == nullptr) continue;
    const Matrix3d rest =
        rig_->rest().volume(vertex.volume).Evaluate(vertex.at).Jacobian();
    (*normals)[v] =
        DeformedNormal(point, rest.transpose() * normals_[v]).normalized();
  }
  for (const SharedVertex& shared : shared_) {
    Vector3d normal;
    DeformShared(shared, frame, &positions[shared.vertex], &normal);
    if (normals) (*normals)[shared.vertex] = normal;
  }
}

size_t LayeredSkin::ByteSize() const {
  return Skin::ByteSize() + sizeof(*this) +
         mesh_.positions.size() * sizeof(Vector3d) * 3 +
         mesh_.triangles.size() * sizeof(Triangle) +
         binding_->vertices.size() * sizeof(VertexBinding) +
         binding_->shares.size() * sizeof(BlendShare) +
         binding_->candidates.size() * sizeof(BindingCandidate) +
         binding_->assignments.size() * sizeof(VertexAssignment) +
         static_cast<size_t>(block_count()) * kernel::kBlockFloats *
             sizeof(float) +
         shared_.size() * sizeof(SharedVertex) +
         parts_.size() * sizeof(VolumeShare) +
         static_cast<size_t>(part_block_count_) * kernel::kPartRows *
             kVerticesPerBlock * sizeof(float);
}

}  // namespace gelenk
