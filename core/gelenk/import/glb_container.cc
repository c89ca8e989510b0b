#include "gelenk/import/glb_container.h"

#include <cstddef>
#include <cstdint>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_format.h"

namespace gelenk {
namespace {

// glTF 2.0, "Binary glTF Layout": magic, version, length of the file; then per
// chunk its length, its type, its bytes.
constexpr absl::string_view kMagic = "glTF";
constexpr absl::string_view kJsonChunk = "JSON";
constexpr absl::string_view kBinaryChunk("BIN\0", 4);
constexpr size_t kHeaderBytes = 12;
constexpr size_t kChunkHeaderBytes = 8;
constexpr uint32_t kVersion = 2;

uint32_t LittleEndian(absl::string_view bytes) {
  uint32_t number = 0;
  for (int i = 3; i >= 0; --i) {
    number = number << 8 | static_cast<unsigned char>(bytes[i]);
  }
  return number;
}

}  // namespace

absl::StatusOr<absl::string_view> JsonOfGltf(absl::string_view bytes) {
  if (!absl::StartsWith(bytes, kMagic)) return bytes;
  if (bytes.size() < kHeaderBytes + kChunkHeaderBytes) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "GLB: cut off in its header, after %d bytes", bytes.size()));
  }
  const uint32_t version = LittleEndian(bytes.substr(4));
  if (version != kVersion) {
    return absl::InvalidArgumentError(
        absl::StrFormat("GLB: want version %d, got %d", kVersion, version));
  }
  const uint32_t length = LittleEndian(bytes.substr(8));
  if (length > bytes.size()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("GLB: cut off: its header says %d bytes, there are %d",
                        length, bytes.size()));
  }
  const uint32_t chunk_length = LittleEndian(bytes.substr(kHeaderBytes));
  const absl::string_view type = bytes.substr(kHeaderBytes + 4, 4);
  bytes.remove_prefix(kHeaderBytes + kChunkHeaderBytes);
  if (type != kJsonChunk) {
    return absl::InvalidArgumentError("GLB: its first chunk is no JSON");
  }
  if (chunk_length > bytes.size()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("GLB: cut off: its JSON has %d bytes, there are %d",
                        chunk_length, bytes.size()));
  }
  return bytes.substr(0, chunk_length);
}

absl::string_view BinaryOfGltf(absl::string_view bytes) {
  const absl::StatusOr<absl::string_view> json = JsonOfGltf(bytes);
  if (!json.ok() || !absl::StartsWith(bytes, kMagic)) return "";
  bytes.remove_prefix(kHeaderBytes + kChunkHeaderBytes + json->size());
  if (bytes.size() < kChunkHeaderBytes) return "";
  const uint32_t length = LittleEndian(bytes);
  if (bytes.substr(4, 4) != kBinaryChunk ||
      length > bytes.size() - kChunkHeaderBytes) {
    return "";
  }
  return bytes.substr(kChunkHeaderBytes, length);
}

}  // namespace gelenk
