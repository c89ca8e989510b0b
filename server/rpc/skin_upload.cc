#include "server/rpc/skin_upload.h"

#include <memory>
#include <utility>

#include "server/rpc/piece_check.h"
#include "server/rpc/skin_creation.h"
#include "server/rpc/upload_call.h"

namespace gelenk::server {
namespace {

bool IsEmpty(const v1::UploadSkinRequest& piece) {
  return piece.mesh().positions().empty() && piece.mesh().triangles().empty() &&
         piece.mesh().normals().empty() && piece.weights().joints().empty() &&
         piece.weights().weights().empty() && piece.assignments().empty();
}

// The weights that the skin has, to be gone on with; null where it has none.
v1::VertexWeights* WeightsOf(v1::Skin& skin) {
  if (skin.has_linear_blend()) return skin.mutable_linear_blend();
  if (skin.has_dual_quaternion()) return skin.mutable_dual_quaternion();
  return nullptr;
}

class SkinUpload final : public Upload<v1::UploadSkinRequest, v1::Skin> {
 public:
  explicit SkinUpload(ServiceState* state) : state_(state) {}

  absl::Status Take(v1::UploadSkinRequest& piece) override {
    if (absl::Status status =
            CheckHeaderComesFirst(piece.has_header(), !has_header_);
        !status.ok()) {
      return status;
    }
    bytes_ += static_cast<int64_t>(piece.ByteSizeLong());
    if (absl::Status status = CheckUploadSize(
            "mesh", bytes_, state_->options.limits.max_import_bytes);
        !status.ok()) {
      return status;
    }
    if (piece.has_header()) {
      has_header_ = true;
      request_.Swap(piece.mutable_header());
    } else if (IsEmpty(piece)) {
      return MalformedPiece("mesh", "a piece holds nothing");
    }
    if (absl::Status status = CheckPlaces(piece); !status.ok()) return status;
    v1::Skin& skin = *request_.mutable_skin();
    if (piece.has_mesh()) Continue(piece.mesh(), skin.mutable_mesh());
    if (piece.has_weights()) Continue(piece.weights(), WeightsOf(skin));
    for (v1::VertexAssignment& more : *piece.mutable_assignments()) {
      skin.mutable_layered_volumes()->add_assignments()->Swap(&more);
    }
    return CheckCounts(skin.mesh());
  }

  absl::Status Complete(const std::function<bool()>& is_cancelled,
                        v1::Skin* response) override {
    if (!has_header_) {
      return MalformedPiece("header", "the first message must hold it");
    }
    return CreateSkin(*state_, request_, is_cancelled, response);
  }

 private:
  // Whether what the piece goes on with is in the header.
  absl::Status CheckPlaces(const v1::UploadSkinRequest& piece) {
    v1::Skin& skin = *request_.mutable_skin();
    if (piece.has_mesh() && !skin.has_mesh()) {
      return MalformedPiece("header.skin.mesh", "unset, but more of it came");
    }
    if (piece.has_weights()) {
      if (WeightsOf(skin) == nullptr) {
        return MalformedPiece(
            "header.skin.linear_blend",
            "unset as is dual_quaternion, but more weights came");
      }
      if (piece.weights().joint_ids_size() > 0 ||
          piece.weights().influences_per_vertex() != 0 ||
          piece.weights().joint_from_mesh_size() > 0) {
        return MalformedPiece("weights", "want joints and weights only");
      }
    }
    if (!piece.assignments().empty() && !skin.has_layered_volumes()) {
      return MalformedPiece("header.skin.layered_volumes",
                            "unset, but assignments came");
    }
    return absl::OkStatus();
  }

  // Early, before the rest has come.
  absl::Status CheckCounts(const v1::TriangleMesh& mesh) const {
    const Limits& limits = state_->options.limits;
    if (mesh.positions_size() / 3 > limits.max_skin_vertices) {
      return MalformedPiece(
          "mesh.positions",
          absl::StrCat("want at most ", limits.max_skin_vertices, " vertices"));
    }
    if (mesh.triangles_size() / 3 > limits.max_skin_triangles) {
      return MalformedPiece(
          "mesh.triangles",
          absl::StrCat("want at most ", limits.max_skin_triangles,
                       " triangles"));
    }
    return absl::OkStatus();
  }

  static void Continue(const v1::TriangleMesh& more, v1::TriangleMesh* mesh) {
    mesh->mutable_positions()->MergeFrom(more.positions());
    mesh->mutable_triangles()->MergeFrom(more.triangles());
    mesh->mutable_normals()->MergeFrom(more.normals());
  }
  static void Continue(const v1::VertexWeights& more,
                       v1::VertexWeights* weights) {
    weights->mutable_joints()->MergeFrom(more.joints());
    weights->mutable_weights()->MergeFrom(more.weights());
  }

  ServiceState* const state_;
  bool has_header_ = false;
  // Grows with the pieces; `bytes_` counts them.
  v1::CreateSkinRequest request_;
  int64_t bytes_ = 0;
};

}  // namespace

void ServeSkinUploads(v1::SkinService::AsyncService* service,
                      ServiceState* state, IoThread* thread) {
  ServeUpload(
      service, &v1::SkinService::AsyncService::RequestUploadSkin,
      [state] { return std::make_unique<SkinUpload>(state); }, state, thread);
}

}  // namespace gelenk::server
