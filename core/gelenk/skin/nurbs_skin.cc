#include "gelenk/skin/nurbs_skin.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/skin/nurbs_collocation.h"

namespace gelenk {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

kernel::TessellateFunction TessellateFor(
    [[maybe_unused]] InstructionSet level) {
#ifdef GELENK_X86_LEVELS
  if (level == InstructionSet::kAvx2) return kernel::avx2::Tessellate;
  if (level == InstructionSet::kAvx512) return kernel::avx512::Tessellate;
#endif
  return kernel::baseline::Tessellate;
}

}  // namespace

absl::StatusOr<std::shared_ptr<const NurbsSkin>> NurbsSkin::Create(
    const VolumeRig& rig, const NurbsSurface& surface,
    const NurbsSkinOptions& options) {
  if (absl::Status status = CheckNurbs(surface); !status.ok()) return status;
  if (!(options.tolerance_m > 0)) {
    Violations violations;
    violations.Add("tolerance_m",
                   absl::StrCat("want > 0 m, got ", options.tolerance_m));
    return violations.ToStatus();
  }
  absl::StatusOr<NurbsFit> fit =
      FitNurbs(rig, surface, options.tolerance_m, options.max_points);
  if (!fit.ok()) return fit.status();
  absl::StatusOr<NurbsTessellation> tessellation =
      TessellateNurbs(*fit, options.tolerance_m, options.max_vertices);
  if (!tessellation.ok()) return tessellation.status();
  return std::shared_ptr<const NurbsSkin>(
      new NurbsSkin(rig, options, *std::move(fit), *std::move(tessellation)));
}

absl::StatusOr<std::shared_ptr<const NurbsSkin>> NurbsSkin::WithMuscles(
    const SkinMuscles& muscles) const {
  const absl::StatusOr<std::shared_ptr<const VolumeRig>> rig =
      greville_->rig().WithMuscles(muscles);
  if (!rig.ok()) return rig.status();
  return Create(**rig, surface_, options_);
}

NurbsSkin::NurbsSkin(const VolumeRig& rig, const NurbsSkinOptions& options,
                     NurbsFit fit, NurbsTessellation tessellation)
    : Skin(rig.shared_skeleton(), tessellation.grid.slots,
           static_cast<int>(tessellation.u.parameters.size() *
                            tessellation.v.parameters.size()) /
               kVerticesPerBlock,
           tessellation.grid.triangles, tessellation.grid.positions,
           rig.rest_positions()),
      options_(options),
      surface_(std::move(fit.surface)),
      topology_(fit.topology),
      greville_(std::move(fit.greville)),
      greville_vertices_(std::move(fit.vertices)),
      greville_weights_(GrevilleWeights(surface_)),
      u_inverse_(std::move(fit.u_inverse)),
      v_inverse_(std::move(fit.v_inverse)),
      estimated_error_m_(fit.error_m),
      tessellation_(std::move(tessellation)),
      tessellate_(TessellateFor(BestInstructionSet())) {}

Eigen::Vector2d NurbsSkin::parameters(int vertex) const {
  return tessellation_.grid.parameters[vertex];
}

void NurbsSkin::FitNet(const VolumeFrame& frame,
                       SkinWorkspace& workspace) const {
  const int rows = surface_.u.count(), columns = surface_.v.count();
  greville_->DeformExactly(frame, workspace.vertices, nullptr);
  workspace.points.resize(rows, 3 * columns);
  workspace.fitted.resize(rows, 3 * columns);
  workspace.net.resize(rows, 3 * columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int at = surface_.index(i, j);
      for (int c = 0; c < 3; ++c) {
        workspace.points(i, c * columns + j) =
            greville_weights_[at] *
            workspace.vertices[greville_vertices_[at]][c];
      }
    }
  }
  // Coefficient by coefficient: products in blocks take memory.
  workspace.fitted = u_inverse_.lazyProduct(workspace.points);
  for (int c = 0; c < 3; ++c) {
    workspace.net.middleCols(c * columns, columns) =
        workspace.fitted.middleCols(c * columns, columns)
            .lazyProduct(v_inverse_.transpose());
  }
}

void NurbsSkin::Deform(const ConstVectorView& positions,
                       const RigidTransform& world_from_skeleton,
                       SkinWorkspace& workspace, VertexBlocks& blocks) const {
  greville_->rig().Evaluate(positions, world_from_skeleton, workspace.frame);
  FitNet(workspace.frame, workspace);
  const int rows = surface_.u.count(), columns = surface_.v.count();
  workspace.rows.resize(4 * surface_.points.size());
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int at = surface_.index(i, j);
      for (int c = 0; c < 3; ++c) {
        workspace.rows[4 * at + c] =
            static_cast<float>(workspace.net(i, c * columns + j));
      }
      workspace.rows[4 * at + 3] = static_cast<float>(surface_.weights[at]);
    }
  }
  const kernel::TessellateLayout layout = {
      rows,
      columns,
      surface_.u.degree,
      surface_.v.degree,
      static_cast<int>(tessellation_.u.parameters.size()),
      static_cast<int>(tessellation_.v.parameters.size()),
      tessellation_.u.first.data(),
      tessellation_.v.first.data(),
      tessellation_.u.values.data(),
      tessellation_.u.slopes.data(),
      tessellation_.v.values.data(),
      tessellation_.v.slopes.data()};
  workspace.sums.resize(static_cast<size_t>(kernel::kSumsPerColumn) * rows *
                        layout.columns);
  blocks.Resize(block_count());
  tessellate_(layout, workspace.rows.data(), workspace.sums.data(),
              blocks.data());
  MendNormals(blocks);
}

// At a pole the surface has no two directions, at a seam it is there twice: the
// mean of what is around.
void NurbsSkin::MendNormals(VertexBlocks& blocks) const {
  const int rows = static_cast<int>(tessellation_.u.parameters.size());
  const int columns = tessellation_.column_count;
  const int padded = static_cast<int>(tessellation_.v.parameters.size());
  const auto slot = [&](int i, int j) { return padded * i + j; };
  const auto set = [&](int at, const Eigen::Vector3f& normal) {
    blocks.Set(at, blocks.position(at), normal.stableNormalized());
  };
  if (topology_.closed_u) {
    for (int j = 0; j < columns; ++j) {
      set(slot(0, j),
          blocks.normal(slot(0, j)) + blocks.normal(slot(rows - 1, j)));
    }
  }
  if (topology_.closed_v) {
    for (int i = 0; i < rows; ++i) {
      set(slot(i, 0),
          blocks.normal(slot(i, 0)) + blocks.normal(slot(i, columns - 1)));
    }
  }
  for (int end = 0; end < 2; ++end) {
    if (topology_.pole[end]) {
      const int beside = end == 0 ? 1 : rows - 2;
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (int j = 0; j < columns - (topology_.closed_v ? 1 : 0); ++j) {
        sum += blocks.normal(slot(beside, j));
      }
      set(slot(end == 0 ? 0 : rows - 1, 0), sum);
    }
    if (topology_.pole[2 + end]) {
      const int beside = end == 0 ? 1 : columns - 2;
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (int i = 0; i < rows - (topology_.closed_u ? 1 : 0); ++i) {
        sum += blocks.normal(slot(i, beside));
      }
      set(slot(0, end == 0 ? 0 : columns - 1), sum);
    }
  }
}

NurbsSurface NurbsSkin::DeformedSurface(
    const ConstVectorView& positions,
    const RigidTransform& world_from_skeleton) const {
  SkinWorkspace workspace;
  greville_->rig().Evaluate(positions, world_from_skeleton, workspace.frame);
  FitNet(workspace.frame, workspace);
  NurbsSurface deformed = surface_;
  const int columns = surface_.v.count();
  for (int i = 0; i < surface_.u.count(); ++i) {
    for (int j = 0; j < columns; ++j) {
      const int at = surface_.index(i, j);
      for (int c = 0; c < 3; ++c) {
        deformed.points[at][c] =
            workspace.net(i, c * columns + j) / surface_.weights[at];
      }
    }
  }
  return deformed;
}

size_t NurbsSkin::ByteSize() const {
  const auto table = [](const NurbsTessellation::AxisTable& t) {
    return t.parameters.size() * sizeof(double) + t.first.size() * sizeof(int) +
           (t.values.size() + t.slopes.size()) * sizeof(float);
  };
  return Skin::ByteSize() + sizeof(*this) + greville_->ByteSize() +
         surface_.points.size() * (sizeof(Vector3d) + 2 * sizeof(double)) +
         (u_inverse_.size() + v_inverse_.size()) * sizeof(double) +
         table(tessellation_.u) + table(tessellation_.v) +
         tessellation_.grid.positions.size() *
             (sizeof(Vector3d) + sizeof(Vector2d) + sizeof(int));
}

}  // namespace gelenk
