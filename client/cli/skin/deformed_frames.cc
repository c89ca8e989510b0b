#include "client/cli/skin/deformed_frames.h"

#include <algorithm>

#include "client/cli/patient_call.h"
#include "client/cli/skin/served_skin.h"
#include "gelenk/skin/vertex_stream.h"

namespace gelenk::cli {
namespace {

// What one call takes.
constexpr size_t kPosesPerCall = 1024;

class FrameReader {
 public:
  absl::Status Read(client::Connection& connection,
                    const v1::DeformSkinRequest& request) {
    grpc::ClientContext context;
    connection.Prepare(PatientCall(), context);
    const auto stream =
        connection.stub<SkinStub>().DeformSkin(&context, request);
    v1::DeformSkinResponse response;
    absl::Status status;
    while (status.ok() && stream->Read(&response)) {
      if (response.has_layout()) TakeLayout(response.layout());
      if (response.has_frame()) status = TakeFrame(response.frame());
    }
    if (!status.ok()) context.TryCancel();
    const absl::Status end = client::FromGrpc(stream->Finish());
    return status.ok() ? end : status;
  }

  DeformedFrames& result() { return result_; }

 private:
  void TakeLayout(const v1::SkinLayout& layout) {
    slots_.assign(layout.slots().begin(), layout.slots().end());
    for (int i = 0; i + 2 < layout.triangles_size(); i += 3) {
      result_.triangles.emplace_back(layout.triangles(i),
                                     layout.triangles(i + 1),
                                     layout.triangles(i + 2));
    }
  }

  absl::Status TakeFrame(const v1::SkinFrame& frame) {
    DeformedFrame& out = result_.frames.emplace_back();
    out.byte_size = static_cast<int64_t>(frame.data().size());
    out.is_keyframe = frame.is_keyframe();
    out.fold_count = frame.folds_size();
    out.clamped_count = frame.clamped_volumes_size();
    switch (frame.encoding()) {
      case v1::VERTEX_ENCODING_FLOAT32: {
        const absl::Status status = DecodeFloats(frame.data(), floats_);
        return status.ok() ? Place(floats_, out) : status;
      }
      case v1::VERTEX_ENCODING_QUANTIZED_16_OCT_8: {
        const absl::Status status = DecodeQuantized(frame.data(), quantized_);
        return status.ok() ? Place(quantized_, out) : status;
      }
      case v1::VERTEX_ENCODING_DELTA: {
        const absl::Status status = delta_.Decode(frame.data(), quantized_);
        return status.ok() ? Place(quantized_, out) : status;
      }
      default:
        return absl::OkStatus();
    }
  }

  template <class Blocks>
  absl::Status Place(const Blocks& blocks, DeformedFrame& frame) const {
    const int slot_count = blocks.block_count() * kVerticesPerBlock;
    for (int slot : slots_) {
      if (slot < 0 || slot >= slot_count) {
        return absl::InternalError("the layout does not fit the frames");
      }
      frame.positions.push_back(blocks.position(slot).template cast<double>());
    }
    return absl::OkStatus();
  }

  DeformedFrames result_;
  std::vector<int> slots_;
  VertexBlocks floats_;
  QuantizedBlocks quantized_;
  DeltaDecoder delta_;
};

}  // namespace

absl::StatusOr<DeformedFrames> DeformSkin(
    client::Connection& connection, const std::string& skin,
    const std::vector<v1::SkinPose>& poses, v1::VertexEncoding encoding) {
  FrameReader reader;
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
