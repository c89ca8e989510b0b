// Frames of a skin as bytes, for whoever draws it elsewhere.
//
// Four encodings, by how much the client does: floats (24 bytes a vertex),
// quantised (8), differences between quantised frames (2 to 3), and
// control planes (about 150 bytes a link, whatever the mesh; see
// control_plane_stream.h). Vertices are in the order of slots, in blocks of
// sixteen; a client maps its vertices by Skin::slots() once.
//
// A frame is a header (VertexStreamHeader, 48 bytes) and what its kind holds,
// all little-endian:
//   kFloat32    per block rows x, y, z, normal x, y, z of sixteen floats
//   kQuantized  per block rows x, y, z of sixteen uint16, two of sixteen int8
//   kDelta      per block the five rows of kQuantized as packed_row.h has it:
//               differences from what the frames before predict (2 a - b of
//               positions, a of normals; modulo 2^16 and 2^8). The frame after
//               a keyframe is predicted as a; in a keyframe it is 0.
//
// Decoders take bytes from anybody: INVALID_ARGUMENT for what is malformed.
// Nothing is allocated once buffers have grown.
#ifndef GELENK_SKIN_VERTEX_STREAM_H_
#define GELENK_SKIN_VERTEX_STREAM_H_

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/skin/vertex_blocks.h"

namespace gelenk {

enum class VertexEncoding : uint8_t {
  kFloat32 = 1,
  kQuantized = 2,
  kDelta = 3,
  kControlPlanes = 4,
};

struct VertexStreamHeader {
  VertexEncoding encoding = VertexEncoding::kFloat32;
  bool is_keyframe = true;
  uint32_t frame_number = 0;
  uint32_t block_count = 0;  // of kControlPlanes: planes
  QuantizationBox box;       // of kQuantized and kDelta
};
inline constexpr size_t kVertexStreamHeaderBytes = 48;
// What a decoder makes room for: a million vertices, and their padding.
inline constexpr uint32_t kMaxStreamBlocks = 1 << 17;

void AppendHeader(const VertexStreamHeader& header, std::string& bytes);
// Checks magic, version, encoding, box and count.
absl::StatusOr<VertexStreamHeader> ReadHeader(absl::string_view bytes);
// The same, and that the encoding is the one that is wanted.
absl::StatusOr<VertexStreamHeader> ReadHeader(absl::string_view bytes,
                                              VertexEncoding encoding);

// Each replaces `bytes`.
void EncodeFloats(const VertexBlocks& blocks, uint32_t frame_number,
                  std::string& bytes);
void EncodeQuantized(const QuantizedBlocks& blocks, uint32_t frame_number,
                     std::string& bytes);
absl::Status DecodeFloats(absl::string_view bytes, VertexBlocks& blocks);
absl::Status DecodeQuantized(absl::string_view bytes, QuantizedBlocks& blocks);

// One stream's frames, each against the two before.
class DeltaEncoder {
 public:
  // A keyframe at least every `keyframe_interval` frames, >= 1.
  explicit DeltaEncoder(int keyframe_interval);

  // Frames of one skin. Replaces `bytes`. Some 40 ns a vertex.
  void Encode(const QuantizedBlocks& blocks, std::string& bytes);
  // The next frame is a keyframe: a client joined, or lost one.
  void RequestKeyframe() { since_keyframe_ = keyframe_interval_; }

 private:
  int keyframe_interval_;
  int since_keyframe_;
  uint32_t frame_number_ = 0;
  // Whether `before_` belongs to the same run of frames.
  int known_frames_ = 0;
  QuantizedBlocks last_;
  QuantizedBlocks before_;
};

class DeltaDecoder {
 public:
  // FAILED_PRECONDITION when the frame builds on one that was not decoded: ask
  // for a keyframe. After an error the decoder waits for a keyframe.
  absl::Status Decode(absl::string_view bytes, QuantizedBlocks& blocks);

 private:
  uint32_t frame_number_ = 0;
  int known_frames_ = 0;
  QuantizedBlocks last_;
  QuantizedBlocks before_;
};

}  // namespace gelenk

#endif  // GELENK_SKIN_VERTEX_STREAM_H_
