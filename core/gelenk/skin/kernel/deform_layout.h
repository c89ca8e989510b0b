// The data that vertices are deformed on: flat, plain, no library type, so that
// it can be compiled once per level of the instruction set.
//
// Vertices come in blocks of 16 of one volume each, row by row: what is read is
// u, s, t and the normal at rest by (u, s, t); what is written is x, y, z and
// the unit normal. No index, no weight, nothing gathered: 24 bytes a vertex in,
// 24 out, or 8 out when quantised.
#ifndef GELENK_SKIN_KERNEL_DEFORM_LAYOUT_H_
#define GELENK_SKIN_KERNEL_DEFORM_LAYOUT_H_

#include <cstdint>

namespace gelenk::kernel {

// Vertices of a block, and the floats that are read or written for it.
inline constexpr int kBlockLanes = 16;
inline constexpr int kBlockRows = 6;
inline constexpr int kBlockFloats = kBlockLanes * kBlockRows;

// Three rows of 16 bits, two rows of 8.
inline constexpr int kQuantizedBlockBytes = kBlockLanes * (3 * 2 + 2);

// The cubic of a volume in the power basis of u: center, s_axis and t_axis, x y
// z each.
struct alignas(64) VolumeCoefficients {
  float powers[4][9];
};

// Blocks [first_block, end_block) lie in `volume`.
struct VolumeRun {
  int volume;
  int first_block;
  int end_block;
};

struct DeformLayout {
  const VolumeCoefficients* volumes;
  const VolumeRun* runs;
  int run_count;
  const float* vertices;  // 64-byte aligned
};

// A coordinate x becomes the whole number nearest to (x - origin) * scale,
// within 0 .. 65535.
struct QuantizationGrid {
  float origin[3];
  float scale;
};

// `out` is kBlockFloats per block, 64-byte aligned.
using DeformFunction = void (*)(const DeformLayout& layout, float* out);

// `out` is kQuantizedBlockBytes per block, 64-byte aligned: rows x, y, z
// (uint16) and the octahedral normal (two rows of int8).
using DeformQuantizedFunction = void (*)(const DeformLayout& layout,
                                         const QuantizationGrid& grid,
                                         uint8_t* out);

// Quantises `block_count` blocks of deformed vertices in the same way.
using QuantizeFunction = void (*)(const float* blocks, int block_count,
                                  const QuantizationGrid& grid, uint8_t* out);

// What one volume has of vertices that several share. Read are kPartRows rows:
// u, s, t; the slopes of (u, s, t) along the first tangent of the surface at
// rest, then along the second; the share; its slopes along the two. Written are
// kPartSumRows rows, to be summed over the volumes: of the position, and of the
// two tangents. `vertices` of the layout are such rows.
inline constexpr int kPartRows = 12;
inline constexpr int kPartSumRows = 9;
using DeformPartsFunction = void (*)(const DeformLayout& layout, float* out);

struct DeformFunctions {
  DeformFunction deform;
  DeformQuantizedFunction deform_quantized;
  DeformPartsFunction deform_parts;
  QuantizeFunction quantize;
};

namespace baseline {
extern const DeformFunctions kDeform;
}
namespace avx2 {
extern const DeformFunctions kDeform;
}
namespace avx512 {
extern const DeformFunctions kDeform;
}

}  // namespace gelenk::kernel

#endif  // GELENK_SKIN_KERNEL_DEFORM_LAYOUT_H_
