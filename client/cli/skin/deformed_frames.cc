#include "client/cli/skin/deformed_frames.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "client/cli/patient_call.h"
#include "client/cli/skin/served_skin.h"
#include "convert/skin_layout.h"
#include "gelenk/skin/control_plane_mesh.h"
#include "gelenk/skin/vertex_stream.h"

namespace gelenk::cli {
namespace {

// What one call takes.
constexpr size_t kPosesPerCall = 1024;

class FrameReader {
 public:
  explicit FrameReader(const std::set<size_t>& kept) : kept_(kept) {}

  absl::Status Read(client::Connection& connection,
                    const v1::DeformSkinRequest& request) {
    grpc::ClientContext context;
    connection.Prepare(PatientCall(), context);
    const auto stream =
        connection.stub<SkinStub>().DeformSkin(&context, request);
    v1::DeformSkinResponse response;
    absl::Status status;
    while (status.ok() && stream->Read(&response)) {
      if (response.has_layout()) status = TakeLayout(response.layout());
      if (response.has_frame()) status = TakeFrame(response.frame());
    }
    if (!status.ok()) context.TryCancel();
    const absl::Status end = client::FromGrpc(stream->Finish());
    return status.ok() ? end : status;
  }

  DeformedFrames& result() { return result_; }

 private:
  absl::Status TakeLayout(const v1::SkinLayout& layout) {
    slots_.assign(layout.slots().begin(), layout.slots().end());
    for (int i = 0; i + 2 < layout.triangles_size(); i += 3) {
      result_.triangles.emplace_back(layout.triangles(i),
                                     layout.triangles(i + 1),
                                     layout.triangles(i + 2));
    }
    if (!layout.has_volumes()) return absl::OkStatus();
    absl::StatusOr<ControlPlaneMesh> mesh =
        ControlPlaneMesh::Create(convert::FromProto(layout.volumes()));
    if (mesh.ok()) mesh_ = *std::move(mesh);
    return mesh.status();
  }

  absl::Status TakeFrame(const v1::SkinFrame& frame) {
    const size_t index = result_.folds.size();
    Count(frame, static_cast<int>(index));
    // Differences need every frame before.
    const bool is_kept = kept_.count(index) > 0;
    if (!is_kept && frame.encoding() != v1::VERTEX_ENCODING_DELTA) {
      return absl::OkStatus();
    }
    switch (frame.encoding()) {
      case v1::VERTEX_ENCODING_FLOAT32: {
        const absl::Status status = DecodeFloats(frame.data(), floats_);
        return status.ok() ? Place(floats_, index) : status;
      }
      case v1::VERTEX_ENCODING_QUANTIZED_16_OCT_8: {
        const absl::Status status = DecodeQuantized(frame.data(), quantized_);
        return status.ok() ? Place(quantized_, index) : status;
      }
      case v1::VERTEX_ENCODING_DELTA: {
        const absl::Status status = delta_.Decode(frame.data(), quantized_);
        return status.ok() && is_kept ? Place(quantized_, index) : status;
      }
      case v1::VERTEX_ENCODING_CONTROL_PLANES:
        if (!mesh_) return absl::InternalError("no layout of volumes came");
        return mesh_->Deform(frame.data(), result_.positions[index], normals_);
      default:
        return absl::InternalError("an encoding of a later version came");
    }
  }

  void Count(const v1::SkinFrame& frame, int index) {
    const auto bytes = static_cast<int64_t>(frame.data().size());
    result_.bytes += bytes;
    result_.most_bytes = std::max(result_.most_bytes, bytes);
    result_.keyframe_count += frame.is_keyframe() ? 1 : 0;
    result_.folds.push_back(frame.folds_size());
    result_.clamp_count += frame.clamped_volumes_size() > 0 ? 1 : 0;
    std::set<std::string> folded;
    for (const v1::VolumeFold& fold : frame.folds()) {
      LinkTrouble& link = result_.links[fold.link_id()];
      if (link.fold_count == 0 || fold.least_jacobian() < link.least_jacobian) {
        link.least_jacobian = fold.least_jacobian();
        link.worst_fold_frame = index;
      }
      if (folded.insert(fold.link_id()).second) ++link.fold_count;
    }
    std::set<std::string> clamped;
    for (const auto& volume : frame.clamped_volumes()) {
      if (clamped.insert(volume.link_id()).second) {
        ++result_.links[volume.link_id()].clamp_count;
      }
    }
  }

  template <class Blocks>
  absl::Status Place(const Blocks& blocks, size_t index) {
    const int slot_count = blocks.block_count() * kVerticesPerBlock;
    std::vector<Eigen::Vector3d>& positions = result_.positions[index];
    positions.reserve(slots_.size());
    for (int slot : slots_) {
      if (slot < 0 || slot >= slot_count) {
        return absl::InternalError("the layout does not fit the frames");
      }
      positions.push_back(blocks.position(slot).template cast<double>());
    }
    return absl::OkStatus();
  }

  const std::set<size_t>& kept_;
  DeformedFrames result_;
  std::vector<int> slots_;
  VertexBlocks floats_;
  QuantizedBlocks quantized_;
  DeltaDecoder delta_;
  std::optional<ControlPlaneMesh> mesh_;
  std::vector<Eigen::Vector3d> normals_;
};

}  // namespace

absl::StatusOr<DeformedFrames> DeformSkin(
    client::Connection& connection, const std::string& skin,
    const std::vector<v1::SkinPose>& poses, v1::VertexEncoding encoding,
    const std::set<size_t>& kept) {
  FrameReader reader(kept);
  for (size_t first = 0; first < poses.size(); first += kPosesPerCall) {
    v1::DeformSkinRequest request;
    request.set_name(skin);
    request.set_encoding(encoding);
    request.set_include_warnings(true);
    request.set_include_layout(first == 0);
    const size_t end = std::min(poses.size(), first + kPosesPerCall);
    for (size_t i = first; i < end; ++i) *request.add_poses() = poses[i];
    const absl::Status status = reader.Read(connection, request);
    if (!status.ok()) return status;
  }
  return std::move(reader.result());
}

}  // namespace gelenk::cli
