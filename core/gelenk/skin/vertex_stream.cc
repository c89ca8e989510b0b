#include "gelenk/skin/vertex_stream.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"

namespace gelenk {
namespace {

static_assert(std::endian::native == std::endian::little,
              "frames are copied as they lie in memory");

constexpr char kMagic[4] = {'G', 'S', 'K', '1'};
constexpr int kLanes = kVerticesPerBlock;
constexpr int kPositionRows = 3;
constexpr int kNormalRows = 2;
constexpr int kPositionBits = 16;
constexpr int kNormalBits = 8;
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
  absl::StatusOr<VertexStreamHeader> read = ReadHeader(bytes);
  if (!read.ok()) return read.status();
  if (read->encoding != encoding) {
    return Malformed(absl::StrCat("has encoding ",
                                  static_cast<int>(read->encoding), ", want ",
                                  static_cast<int>(encoding)));
  }
  *header = *read;
  bytes.remove_prefix(kVertexStreamHeaderBytes);
  if (size > 0 && bytes.size() != size * header->block_count) {
    return Malformed(absl::StrCat(header->block_count, " blocks are ",
                                  size * header->block_count, " bytes, got ",
                                  bytes.size()));
  }
  return bytes;
}

// The numbers of one row of a block; `row` counts positions, then normals.
void LoadRow(const uint8_t* block, int row, uint16_t* numbers) {
  if (row < kPositionRows) {
    std::memcpy(numbers, block + row * kLanes * 2, kLanes * 2);
    return;
  }
  const uint8_t* bytes =
      block + kPositionRows * kLanes * 2 + (row - kPositionRows) * kLanes;
  for (int i = 0; i < kLanes; ++i) numbers[i] = bytes[i];
}

void StoreRow(const uint16_t* numbers, int row, uint8_t* block) {
  if (row < kPositionRows) {
    std::memcpy(block + row * kLanes * 2, numbers, kLanes * 2);
    return;
  }
  uint8_t* bytes =
      block + kPositionRows * kLanes * 2 + (row - kPositionRows) * kLanes;
  for (int i = 0; i < kLanes; ++i) bytes[i] = static_cast<uint8_t>(numbers[i]);
}

// Small differences of either sign as small numbers, within `bits`.
uint16_t Fold(uint16_t difference, int bits) {
  const int32_t wide = bits == kNormalBits ? static_cast<int8_t>(difference)
                                           : static_cast<int16_t>(difference);
  return static_cast<uint16_t>((wide << 1) ^ (wide >> 31));
}
uint16_t Unfold(uint16_t folded) {
  return static_cast<uint16_t>((folded >> 1) ^ -(folded & 1));
}

// What the frames before say that a row will be. Null where there is none.
void Predict(const uint8_t* last, const uint8_t* before, int row,
             uint16_t* numbers) {
  LoadRow(last, row, numbers);
  if (before == nullptr || row >= kPositionRows) return;
  uint16_t older[kLanes];
  LoadRow(before, row, older);
  for (int i = 0; i < kLanes; ++i) {
    numbers[i] = static_cast<uint16_t>(2 * numbers[i] - older[i]);
  }
}

void PackRow(const uint16_t* folded, std::string& bytes) {
  unsigned any = 0;
  for (int i = 0; i < kLanes; ++i) any |= folded[i];
  const int bits = std::bit_width(any);
  // 2 bits bytes: 16 numbers of that many bits.
  char packed[1 + 2 * kPositionBits];
  int size = 0;
  packed[size++] = static_cast<char>(bits);
  uint64_t pending = 0;
  int pending_bits = 0;
  for (int i = 0; i < kLanes; ++i) {
    pending |= uint64_t{folded[i]} << pending_bits;
    pending_bits += bits;
    for (; pending_bits >= 8; pending_bits -= 8) {
      packed[size++] = static_cast<char>(pending);
      pending >>= 8;
    }
  }
  bytes.append(packed, size);
}

// False when `bytes` end too early or the row is wider than it can be.
bool UnpackRow(absl::string_view& bytes, int most_bits, uint16_t* folded) {
  if (bytes.empty()) return false;
  const int bits = static_cast<uint8_t>(bytes[0]);
  bytes.remove_prefix(1);
  if (bits > most_bits || bytes.size() < static_cast<size_t>(2 * bits)) {
    return false;
  }
  uint64_t pending = 0;
  int pending_bits = 0;
  size_t next = 0;
  for (int i = 0; i < kLanes; ++i) {
    for (; pending_bits < bits; pending_bits += 8) {
      pending |= uint64_t{static_cast<uint8_t>(bytes[next++])} << pending_bits;
    }
    folded[i] = static_cast<uint16_t>(pending & ((1u << bits) - 1));
    pending >>= bits;
    pending_bits -= bits;
  }
  bytes.remove_prefix(2 * bits);
  return true;
}

int BitsOf(int row) {
  return row < kPositionRows ? kPositionBits : kNormalBits;
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

DeltaEncoder::DeltaEncoder(int keyframe_interval)
    : keyframe_interval_(std::max(1, keyframe_interval)),
      since_keyframe_(keyframe_interval_) {}

void DeltaEncoder::Encode(const QuantizedBlocks& blocks, std::string& bytes) {
  const bool is_keyframe = since_keyframe_ >= keyframe_interval_ ||
                           last_.block_count() != blocks.block_count();
  if (is_keyframe) known_frames_ = 0;
  bytes.clear();
  AppendHeader({VertexEncoding::kDelta, is_keyframe, frame_number_,
                static_cast<uint32_t>(blocks.block_count()), blocks.box},
               bytes);
  for (int b = 0; b < blocks.block_count(); ++b) {
    const size_t at = static_cast<size_t>(kBlockBytes) * b;
    for (int row = 0; row < kPositionRows + kNormalRows; ++row) {
      uint16_t numbers[kLanes];
      uint16_t predicted[kLanes] = {};
      LoadRow(blocks.data() + at, row, numbers);
      if (is_keyframe) {
        std::copy(numbers, numbers + kLanes - 1, predicted + 1);
      } else {
        Predict(last_.data() + at,
                known_frames_ > 1 ? before_.data() + at : nullptr, row,
                predicted);
      }
      for (int i = 0; i < kLanes; ++i) {
        numbers[i] =
            Fold(static_cast<uint16_t>(numbers[i] - predicted[i]), BitsOf(row));
      }
      PackRow(numbers, bytes);
    }
  }
  std::swap(last_, before_);
  last_ = blocks;
  known_frames_ = std::min(known_frames_ + 1, 2);
  since_keyframe_ = is_keyframe ? 1 : since_keyframe_ + 1;
  ++frame_number_;
}

absl::Status DeltaDecoder::Decode(absl::string_view bytes,
                                  QuantizedBlocks& blocks) {
  VertexStreamHeader header;
  absl::StatusOr<absl::string_view> body =
      BodyOf(bytes, VertexEncoding::kDelta, 0, &header);
  const int known_frames = std::exchange(known_frames_, 0);
  if (!body.ok()) return body.status();
  if (!header.is_keyframe &&
      (known_frames == 0 || header.frame_number != frame_number_ + 1 ||
       static_cast<int>(header.block_count) != last_.block_count())) {
    return absl::FailedPreconditionError(
        absl::StrCat("frame ", header.frame_number,
                     " builds on one that is not here: ask "
                     "for a keyframe"));
  }
  // At least a byte a row.
  if (body->size() <
      size_t{header.block_count} * (kPositionRows + kNormalRows)) {
    return Malformed("ends too early");
  }
  blocks.Resize(static_cast<int>(header.block_count));
  blocks.box = header.box;
  for (int b = 0; b < blocks.block_count(); ++b) {
    const size_t at = static_cast<size_t>(kBlockBytes) * b;
    for (int row = 0; row < kPositionRows + kNormalRows; ++row) {
      uint16_t numbers[kLanes];
      if (!UnpackRow(*body, BitsOf(row), numbers)) {
        return Malformed(
            absl::StrCat("block ", b, " row ", row, " is malformed"));
      }
      uint16_t predicted[kLanes];
      if (!header.is_keyframe) {
        Predict(last_.data() + at,
                known_frames > 1 ? before_.data() + at : nullptr, row,
                predicted);
      }
      uint16_t previous = 0;
      for (int i = 0; i < kLanes; ++i) {
        numbers[i] = static_cast<uint16_t>(
            Unfold(numbers[i]) +
            (header.is_keyframe ? previous : predicted[i]));
        previous = numbers[i];
      }
      StoreRow(numbers, row, blocks.data() + at);
    }
  }
  if (!body->empty()) return Malformed("goes on behind its last block");
  std::swap(last_, before_);
  last_ = blocks;
  frame_number_ = header.frame_number;
  known_frames_ = header.is_keyframe ? 1 : std::min(known_frames + 1, 2);
  return absl::OkStatus();
}

}  // namespace gelenk
