#include <algorithm>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/skin/packed_row.h"
#include "gelenk/skin/vertex_stream.h"

namespace gelenk {
namespace {

constexpr int kLanes = kVerticesPerBlock;
static_assert(kLanes == kPackedLanes, "a row of a block is one packed row");
constexpr int kPositionRows = 3;
constexpr int kNormalRows = 2;
constexpr int kBlockBytes = kernel::kQuantizedBlockBytes;

absl::Status Malformed(absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat("vertex frame: ", what));
}

int BitsOf(int row) { return row < kPositionRows ? 16 : 8; }

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

}  // namespace

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
      if (!is_keyframe) {
        Predict(last_.data() + at,
                known_frames_ > 1 ? before_.data() + at : nullptr, row,
                predicted);
      }
      for (int i = 0; i < kLanes; ++i) {
        numbers[i] = static_cast<uint16_t>(numbers[i] - predicted[i]);
      }
      PackRow(numbers, BitsOf(row), bytes);
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
  const int known_frames = std::exchange(known_frames_, 0);
  const absl::StatusOr<VertexStreamHeader> read =
      ReadHeader(bytes, VertexEncoding::kDelta);
  if (!read.ok()) return read.status();
  const VertexStreamHeader& header = *read;
  absl::string_view body = bytes.substr(kVertexStreamHeaderBytes);
  if (!header.is_keyframe &&
      (known_frames == 0 || header.frame_number != frame_number_ + 1 ||
       static_cast<int>(header.block_count) != last_.block_count())) {
    return absl::FailedPreconditionError(
        absl::StrCat("frame ", header.frame_number,
                     " builds on one that is not here: ask "
                     "for a keyframe"));
  }
  // At least a byte a row.
  if (body.size() <
      size_t{header.block_count} * (kPositionRows + kNormalRows)) {
    return Malformed("ends too early");
  }
  blocks.Resize(static_cast<int>(header.block_count));
  blocks.box = header.box;
  for (int b = 0; b < blocks.block_count(); ++b) {
    const size_t at = static_cast<size_t>(kBlockBytes) * b;
    for (int row = 0; row < kPositionRows + kNormalRows; ++row) {
      uint16_t numbers[kLanes];
      if (!UnpackRow(body, BitsOf(row), numbers)) {
        return Malformed(
            absl::StrCat("block ", b, " row ", row, " is malformed"));
      }
      uint16_t predicted[kLanes] = {};
      if (!header.is_keyframe) {
        Predict(last_.data() + at,
                known_frames > 1 ? before_.data() + at : nullptr, row,
                predicted);
      }
      for (int i = 0; i < kLanes; ++i) {
        numbers[i] = static_cast<uint16_t>(numbers[i] + predicted[i]);
      }
      StoreRow(numbers, row, blocks.data() + at);
    }
  }
  if (!body.empty()) return Malformed("goes on behind its last block");
  std::swap(last_, before_);
  last_ = blocks;
  frame_number_ = header.frame_number;
  known_frames_ = header.is_keyframe ? 1 : std::min(known_frames + 1, 2);
  return absl::OkStatus();
}

}  // namespace gelenk
