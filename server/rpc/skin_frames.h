// The frames of one viewer of a skin: poses in, encoded vertices out.
//
// Not thread-safe. Takes no memory from frame to frame but what the message
// takes. Cost: deformation and encoding, some 12 ns a vertex for differences, 2
// for the others.
#ifndef GELENK_SERVER_RPC_SKIN_FRAMES_H_
#define GELENK_SERVER_RPC_SKIN_FRAMES_H_

#include <cstdint>
#include <memory>

#include "absl/status/statusor.h"
#include "gelenk/base/parallel_for.h"
#include "gelenk/skin/skin.h"
#include "gelenk/skin/vertex_stream.h"
#include "gelenk/v1/skin_service.pb.h"
#include "server/store/skin_store.h"

namespace gelenk::server {

struct SkinFrameOptions {
  v1::VertexEncoding encoding = v1::VERTEX_ENCODING_UNSPECIFIED;
  // 0 means kDefaultKeyframeInterval.
  int keyframe_interval = 0;
  bool include_warnings = false;
};
// A second at 60 Hz: what a viewer that lost one waits at most.
inline constexpr int kDefaultKeyframeInterval = 60;

class SkinFrames {
 public:
  // INVALID_ARGUMENT naming "encoding" or "keyframe_interval".
  // `parallel_for` deforms large skins in parts; may be empty.
  static absl::StatusOr<std::unique_ptr<SkinFrames>> Create(
      StoredSkin stored, const SkinFrameOptions& options,
      ParallelFor parallel_for);

  const StoredSkin& stored() const { return stored_; }

  // What the viewer needs once.
  void FillLayout(v1::SkinLayout* proto) const;

  // The next frame needs none before it.
  void RequestKeyframe() { delta_.RequestKeyframe(); }

  // The next frame, but for its sequence number. `positions` are of the skin's
  // skeleton.
  void Deform(const ConstVectorView& positions,
              const RigidTransform& world_from_skeleton, v1::SkinFrame* proto);

 private:
  SkinFrames(StoredSkin stored, v1::VertexEncoding encoding,
             const SkinFrameOptions& options, ParallelFor parallel_for);

  void Encode(const ConstVectorView& positions,
              const RigidTransform& world_from_skeleton, std::string* bytes);
  void AddWarnings(v1::SkinFrame* proto) const;

  const StoredSkin stored_;
  const Skin& skin_;
  const v1::VertexEncoding encoding_;
  const bool include_warnings_;
  SkinWorkspace workspace_;
  VertexBlocks blocks_;
  QuantizedBlocks quantized_;
  DeltaEncoder delta_;
  uint32_t frame_number_ = 0;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SKIN_FRAMES_H_
