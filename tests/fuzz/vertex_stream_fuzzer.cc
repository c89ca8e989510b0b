// Frames of a skin from anybody: refused, or vertices that encode and decode to
// the same again. The input is a stream: frames behind two bytes of length
// each, the lowest first.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/skeleton/skeleton_builder.h"
#include "gelenk/skin/control_plane_stream.h"
#include "gelenk/skin/vertex_stream.h"
#include "tests/fuzz/fuzz_check.h"

namespace gelenk {
namespace {

constexpr size_t kMaxMessageBytes = 1024;

// Two links.
std::shared_ptr<const VolumeRig> MakeRig() {
  SkeletonBuilder builder;
  for (const char* id : {"upper", "lower"}) {
    Joint joint;
    joint.id = id;
    joint.type = JointType::kSpherical;
    joint.link_length_m = 1;
    if (joint.id == "lower") {
      joint.parent_id = "upper";
      joint.parent_from_joint.translation.x() = 1;
    }
    builder.AddJoint(joint);
  }
  return VolumeRig::Create(builder.Build().value()).value();
}

bool AreSame(const QuantizedBlocks& a, const QuantizedBlocks& b) {
  return a.block_count() == b.block_count() &&
         (a.block_count() == 0 ||
          std::memcmp(a.data(), b.data(),
                      static_cast<size_t>(kernel::kQuantizedBlockBytes) *
                          a.block_count()) == 0);
}

void DecodeAll(absl::string_view frame, const VolumeRig& rig,
               DeltaDecoder& decoder) {
  VertexBlocks floats;
  QuantizedBlocks blocks;
  std::vector<BezierVolume> volumes;
  for (const absl::Status& status :
       {DecodeFloats(frame, floats), DecodeQuantized(frame, blocks),
        DecodeControlPlanes(rig, frame, volumes)}) {
    if (!status.ok()) CheckRefusal(status, kMaxMessageBytes);
  }
  const absl::Status status = decoder.Decode(frame, blocks);
  if (status.code() == absl::StatusCode::kFailedPrecondition) return;
  if (!status.ok()) {
    CheckRefusal(status, kMaxMessageBytes);
    return;
  }
  std::string bytes;
  DeltaEncoder(1).Encode(blocks, bytes);
  QuantizedBlocks back;
  GELENK_FUZZ_CHECK(DeltaDecoder().Decode(bytes, back).ok());
  GELENK_FUZZ_CHECK(AreSame(blocks, back));
}

void Run(absl::string_view bytes) {
  static const auto& rig = *new std::shared_ptr<const VolumeRig>(MakeRig());
  DeltaDecoder decoder;
  while (bytes.size() >= 2) {
    const size_t size = static_cast<uint8_t>(bytes[0]) |
                        static_cast<size_t>(static_cast<uint8_t>(bytes[1]))
                            << 8;
    bytes.remove_prefix(2);
    DecodeAll(bytes.substr(0, size), *rig, decoder);
    bytes.remove_prefix(std::min(size, bytes.size()));
  }
}

}  // namespace
}  // namespace gelenk

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  gelenk::Run({reinterpret_cast<const char*>(data), size});
  return 0;
}
