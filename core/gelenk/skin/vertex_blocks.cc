#include "gelenk/skin/vertex_blocks.h"

#include <algorithm>
#include <cmath>

namespace gelenk {

Eigen::Vector3d QuantizedBlocks::position(int slot) const {
  const uint16_t* words = reinterpret_cast<const uint16_t*>(
      blocks_[slot / kVerticesPerBlock].bytes);
  const int lane = slot % kVerticesPerBlock;
  const double step = box.size_m / 65535;
  return box.origin +
         step * Eigen::Vector3d(words[lane], words[kVerticesPerBlock + lane],
                                words[2 * kVerticesPerBlock + lane]);
}

Eigen::Vector3d QuantizedBlocks::normal(int slot) const {
  const int8_t* bytes =
      reinterpret_cast<const int8_t*>(blocks_[slot / kVerticesPerBlock].bytes) +
      3 * sizeof(uint16_t) * kVerticesPerBlock;
  const int lane = slot % kVerticesPerBlock;
  return FromOctahedral(bytes[lane], bytes[kVerticesPerBlock + lane]);
}

void QuantizedBlocks::SetSlot(const uint8_t* block, int lane, int slot) {
  uint8_t* target = blocks_[slot / kVerticesPerBlock].bytes;
  const int target_lane = slot % kVerticesPerBlock;
  const auto copy = [&](int row, int width) {
    std::copy_n(block + row + lane * width, width,
                target + row + target_lane * width);
  };
  for (int k = 0; k < 3; ++k) copy(2 * k * kVerticesPerBlock, 2);
  for (int k = 0; k < 2; ++k) copy((6 + k) * kVerticesPerBlock, 1);
}

Eigen::Vector3d FromOctahedral(int8_t x, int8_t y) {
  Eigen::Vector3d v(x / 127.0, y / 127.0, 0);
  v.z() = 1 - std::abs(v.x()) - std::abs(v.y());
  if (v.z() < 0) {
    const double folded_x = 1 - std::abs(v.y());
    const double folded_y = 1 - std::abs(v.x());
    v.x() = v.x() < 0 ? -folded_x : folded_x;
    v.y() = v.y() < 0 ? -folded_y : folded_y;
  }
  return v.normalized();
}

}  // namespace gelenk
