#include "gelenk/skin/vertex_stream.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "absl/strings/str_cat.h"

namespace gelenk {
namespace {

static_assert(std::endian::native == std::endian::little,
              "frames are copied as they lie in memory");

constexpr char kMagic[4] = {'G', 'S', 'K', '1'};
constexpr int kBlockBytes = kernel::kQuantizedBlockBytes;

template <typename Number>
void Append(Number number, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

template <typename Number>
Number Take(absl::string_view& bytes) {
  Number number;
  std::memcpy(&number, bytes.data(), sizeof(number));
  bytes.remove_prefix(sizeof(number));
  return number;
}

absl::Status Malformed(absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat("vertex frame: ", what));
}

// What follows the header must be `size` bytes a block.
absl::StatusOr<absl::string_view> BodyOf(absl::string_view bytes,
                                         VertexEncoding encoding, size_t size,
                                         VertexStreamHeader* header) {
  absl::StatusOr<VertexStreamHeader> read = ReadHeader(bytes, encoding);
  if (!read.ok()) return read.status();
  *header = *read;
  bytes.remove_prefix(kVertexStreamHeaderBytes);
  if (bytes.size() != size * header->block_count) {
    return Malformed(absl::StrCat(header->block_count, " blocks are ",
                                  size * header->block_count, " bytes, got ",
                                  bytes.size()));
  }
  return bytes;
}

}  // namespace

void AppendHeader(const VertexStreamHeader& header, std::string& bytes) {
  bytes.append(kMagic, sizeof(kMagic));
  Append(static_cast<uint8_t>(header.encoding), bytes);
  Append(static_cast<uint8_t>(header.is_keyframe), bytes);
  Append(uint16_t{0}, bytes);
  Append(header.frame_number, bytes);
  Append(header.block_count, bytes);
  for (int k = 0; k < 3; ++k) Append(header.box.origin[k], bytes);
  Append(header.box.size_m, bytes);
}

absl::StatusOr<VertexStreamHeader> ReadHeader(absl::string_view bytes) {
  if (bytes.size() < kVertexStreamHeaderBytes) {
    return Malformed(absl::StrCat("want at least ", kVertexStreamHeaderBytes,
                                  " bytes, got ", bytes.size()));
  }
  if (std::memcmp(bytes.data(), kMagic, sizeof(kMagic)) != 0) {
    return Malformed("does not begin with GSK1");
  }
  bytes.remove_prefix(sizeof(kMagic));
  VertexStreamHeader header;
  const int encoding = Take<uint8_t>(bytes);
  if (encoding < 1 || encoding > 4) {
    return Malformed(absl::StrCat("unknown encoding ", encoding));
  }
  header.encoding = static_cast<VertexEncoding>(encoding);
  header.is_keyframe = Take<uint8_t>(bytes) != 0;
  Take<uint16_t>(bytes);
  header.frame_number = Take<uint32_t>(bytes);
  header.block_count = Take<uint32_t>(bytes);
  if (header.block_count > kMaxStreamBlocks) {
    return Malformed(absl::StrCat("want at most ", kMaxStreamBlocks,
                                  " blocks, got ", header.block_count));
  }
  for (int k = 0; k < 3; ++k) header.box.origin[k] = Take<double>(bytes);
  header.box.size_m = Take<double>(bytes);
  if (!header.box.origin.allFinite() || !std::isfinite(header.box.size_m) ||
      header.box.size_m <= 0) {
    return Malformed("the box is malformed");
  }
  return header;
}

absl::StatusOr<VertexStreamHeader> ReadHeader(absl::string_view bytes,
                                              VertexEncoding encoding) {
  absl::StatusOr<VertexStreamHeader> header = ReadHeader(bytes);
  if (header.ok() && header->encoding != encoding) {
    return Malformed(absl::StrCat("has encoding ",
                                  static_cast<int>(header->encoding), ", want ",
                                  static_cast<int>(encoding)));
  }
  return header;
}

void EncodeFloats(const VertexBlocks& blocks, uint32_t frame_number,
                  std::string& bytes) {
  bytes.clear();
  AppendHeader({VertexEncoding::kFloat32,
                true,
                frame_number,
                static_cast<uint32_t>(blocks.block_count()),
                {}},
               bytes);
  bytes.append(reinterpret_cast<const char*>(blocks.data()),
               sizeof(float) * kernel::kBlockFloats * blocks.block_count());
}

absl::Status DecodeFloats(absl::string_view bytes, VertexBlocks& blocks) {
  VertexStreamHeader header;
  const absl::StatusOr<absl::string_view> body =
      BodyOf(bytes, VertexEncoding::kFloat32,
             sizeof(float) * kernel::kBlockFloats, &header);
  if (!body.ok()) return body.status();
  blocks.Resize(static_cast<int>(header.block_count));
  if (!body->empty()) std::memcpy(blocks.data(), body->data(), body->size());
  return absl::OkStatus();
}

void EncodeQuantized(const QuantizedBlocks& blocks, uint32_t frame_number,
                     std::string& bytes) {
  bytes.clear();
  AppendHeader({VertexEncoding::kQuantized, true, frame_number,
                static_cast<uint32_t>(blocks.block_count()), blocks.box},
               bytes);
  bytes.append(reinterpret_cast<const char*>(blocks.data()),
               static_cast<size_t>(kBlockBytes) * blocks.block_count());
}

absl::Status DecodeQuantized(absl::string_view bytes, QuantizedBlocks& blocks) {
  VertexStreamHeader header;
  const absl::StatusOr<absl::string_view> body =
      BodyOf(bytes, VertexEncoding::kQuantized, kBlockBytes, &header);
  if (!body.ok()) return body.status();
  blocks.Resize(static_cast<int>(header.block_count));
  blocks.box = header.box;
  if (!body->empty()) std::memcpy(blocks.data(), body->data(), body->size());
  return absl::OkStatus();
}

}  // namespace gelenk
