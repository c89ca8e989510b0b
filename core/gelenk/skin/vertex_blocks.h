// Deformed vertices, in blocks of sixteen.
//
// A vertex has a slot; slot / 16 is its block. A block is six rows of sixteen
// floats: x, y, z (world frame, m) and the unit normal. Some slots are padding:
// they hold finite numbers that mean nothing.
#ifndef GELENK_SKIN_VERTEX_BLOCKS_H_
#define GELENK_SKIN_VERTEX_BLOCKS_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/skin/kernel/deform_layout.h"

namespace gelenk {

inline constexpr int kVerticesPerBlock = kernel::kBlockLanes;

inline int BlocksFor(int vertex_count) {
  return (vertex_count + kVerticesPerBlock - 1) / kVerticesPerBlock;
}

// Blocks of any number of rows of sixteen floats, 64-byte aligned.
class BlockRows {
 public:
  // Allocates only to grow; new rows are zero.
  void Resize(int block_count, int rows_per_block) {
    rows_per_block_ = rows_per_block;
    rows_.resize(static_cast<size_t>(block_count) * rows_per_block);
  }

  float* data() { return rows_.data()->floats; }
  const float* data() const { return rows_.data()->floats; }
  float& at(int slot, int row) {
    return RowOf(slot, row).floats[slot % kVerticesPerBlock];
  }

 private:
  struct alignas(64) Row {
    float floats[kVerticesPerBlock];
  };
  Row& RowOf(int slot, int row) {
    return rows_[static_cast<size_t>(slot / kVerticesPerBlock) *
                     rows_per_block_ +
                 row];
  }

  std::vector<Row> rows_;
  int rows_per_block_ = 1;
};

class VertexBlocks {
 public:
  // Allocates only to grow; new slots are zero.
  void Resize(int block_count) {
    lines_.resize(static_cast<size_t>(block_count) * kLinesPerBlock);
  }

  int block_count() const {
    return static_cast<int>(lines_.size() / kLinesPerBlock);
  }
  // 64-byte aligned, kernel::kBlockFloats a block.
  float* data() { return lines_.data()->floats; }
  const float* data() const { return lines_.data()->floats; }

  Eigen::Vector3f position(int slot) const { return Rows(slot, 0); }
  Eigen::Vector3f normal(int slot) const { return Rows(slot, 3); }
  void Set(int slot, const Eigen::Vector3f& position,
           const Eigen::Vector3f& normal) {
    float* at = data() + Offset(slot);
    for (int k = 0; k < 3; ++k) {
      at[k * kVerticesPerBlock] = position[k];
      at[(3 + k) * kVerticesPerBlock] = normal[k];
    }
  }

 private:
  struct alignas(64) Line {
    float floats[16];
  };
  static constexpr int kLinesPerBlock = kernel::kBlockFloats / 16;

  static int64_t Offset(int slot) {
    return int64_t{kernel::kBlockFloats} * (slot / kVerticesPerBlock) +
           slot % kVerticesPerBlock;
  }
  Eigen::Vector3f Rows(int slot, int first) const {
    const float* at = data() + Offset(slot) + first * kVerticesPerBlock;
    return {at[0], at[kVerticesPerBlock], at[2 * kVerticesPerBlock]};
  }

  std::vector<Line> lines_;
};

// The same as 16 bits a coordinate and an octahedral normal of 8 + 8 bits: a
// cube of `size_m` with its corner at `origin` is cut into 65535 steps a side.
struct QuantizationBox {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double size_m = 1;
};

class QuantizedBlocks {
 public:
  void Resize(int block_count) {
    blocks_.resize(static_cast<size_t>(block_count));
  }
  int block_count() const { return static_cast<int>(blocks_.size()); }

  // 64-byte aligned; per block rows x, y, z (uint16, the machine's byte order)
  // and two rows of int8.
  uint8_t* data() { return blocks_.data()->bytes; }
  const uint8_t* data() const { return blocks_.data()->bytes; }

  QuantizationBox box;

  Eigen::Vector3d position(int slot) const;
  Eigen::Vector3d normal(int slot) const;  // unit

  // From lane `lane` of a block in the same box.
  void SetSlot(const uint8_t* block, int lane, int slot);

 private:
  struct alignas(64) Block {
    uint8_t bytes[kernel::kQuantizedBlockBytes];
  };

  std::vector<Block> blocks_;
};

// By how much a quantised normal may be off: 1.0 degree.
inline constexpr double kOctahedralErrorRad = 0.0175;

// The unit vector of an octahedral code.
Eigen::Vector3d FromOctahedral(int8_t x, int8_t y);

}  // namespace gelenk

#endif  // GELENK_SKIN_VERTEX_BLOCKS_H_
