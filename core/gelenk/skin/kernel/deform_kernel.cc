// Vertices through their volumes, compiled once per level of the instruction
// set: GELENK_KERNEL_LEVEL names the level.
//
// Plain loops over the sixteen lanes of a block; the compiler makes vectors of
// them.
#include "gelenk/base/kernel/lanes.h"
#include "gelenk/skin/kernel/deform_layout.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// Blocks ahead.
constexpr int kAhead = 4;

// Of a vertex, unit or not.
struct Deformed {
  float x, y, z;
  float nx, ny, nz;
};

// The plane at u and its derivative by u, by Horner's rule at once.
GELENK_INLINE void PlaneAt(const VolumeCoefficients& volume, float u, float* p,
                           float* d) {
  for (int i = 0; i < 9; ++i) {
    const float third = volume.powers[3][i] * u + volume.powers[2][i];
    const float second = third * u + volume.powers[1][i];
    p[i] = second * u + volume.powers[0][i];
    d[i] = (volume.powers[3][i] * u + third) * u + second;
  }
}

// `in` points to the vertex' first row.
GELENK_INLINE Deformed DeformVertex(const VolumeCoefficients& volume,
                                    const float* in) {
  const float u = in[0 * kBlockLanes];
  const float s = in[1 * kBlockLanes];
  const float t = in[2 * kBlockLanes];
  const float nu = in[3 * kBlockLanes];
  const float ns = in[4 * kBlockLanes];
  const float nt = in[5 * kBlockLanes];
  float p[9];
  float d[9];
  PlaneAt(volume, u, p, d);
  const float* a = p + 3;
  const float* b = p + 6;
  const float fx = d[0] + s * d[3] + t * d[6];
  const float fy = d[1] + s * d[4] + t * d[7];
  const float fz = d[2] + s * d[5] + t * d[8];
  // nu (a x b) + F_u x (nt a - ns b).
  const float wx = nt * a[0] - ns * b[0];
  const float wy = nt * a[1] - ns * b[1];
  const float wz = nt * a[2] - ns * b[2];
  Deformed out;
  out.x = p[0] + s * a[0] + t * b[0];
  out.y = p[1] + s * a[1] + t * b[1];
  out.z = p[2] + s * a[2] + t * b[2];
  out.nx = nu * (a[1] * b[2] - a[2] * b[1]) + (fy * wz - fz * wy);
  out.ny = nu * (a[2] * b[0] - a[0] * b[2]) + (fz * wx - fx * wz);
  out.nz = nu * (a[0] * b[1] - a[1] * b[0]) + (fx * wy - fy * wx);
  return out;
}

// Whole numbers as 32 bits: narrowed in a loop of its own, or the compiler
// makes no vectors.
GELENK_INLINE int32_t OnGrid(float x, float scale) {
  // Cut off before the conversion, which is undefined beyond.
  float steps = x * scale + 0.5f;
  steps = steps > 0 ? steps : 0;
  steps = steps < 65535 ? steps : 65535;
  return static_cast<int32_t>(steps);
}

// x lies in [-1, 1].
GELENK_INLINE int32_t OnOctahedron(float x) {
  return static_cast<int32_t>(x * 127 + 127.5f) - 127;
}

// `from` is a block of floats, its normals unit or not; `to` a quantised block.
GELENK_INLINE void QuantizeBlock(const float* __restrict from,
                                 const QuantizationGrid& grid,
                                 uint8_t* __restrict to) {
  int32_t whole[3 * kBlockLanes];
  int32_t octahedral[2 * kBlockLanes];
  for (int k = 0; k < 3; ++k) {
    const float* row = from + k * kBlockLanes;
    const float origin = grid.origin[k];
#pragma omp simd
    for (int i = 0; i < kBlockLanes; ++i) {
      whole[k * kBlockLanes + i] = OnGrid(row[i] - origin, grid.scale);
    }
  }
  const float* nx = from + 3 * kBlockLanes;
  const float* ny = from + 4 * kBlockLanes;
  const float* nz = from + 5 * kBlockLanes;
#pragma omp simd
  for (int i = 0; i < kBlockLanes; ++i) {
    const float sum = __builtin_fabsf(nx[i]) + __builtin_fabsf(ny[i]) +
                      __builtin_fabsf(nz[i]);
    const float inverse = 1 / (sum > 1e-30f ? sum : 1e-30f);
    const float px = nx[i] * inverse;
    const float py = ny[i] * inverse;
    // The lower half is folded outwards.
    const float folded_x = 1 - __builtin_fabsf(py);
    const float folded_y = 1 - __builtin_fabsf(px);
    const float lower_x = px < 0 ? -folded_x : folded_x;
    const float lower_y = py < 0 ? -folded_y : folded_y;
    octahedral[i] = OnOctahedron(nz[i] < 0 ? lower_x : px);
    octahedral[kBlockLanes + i] = OnOctahedron(nz[i] < 0 ? lower_y : py);
  }
  uint16_t* words = reinterpret_cast<uint16_t*>(to);
  int8_t* bytes = reinterpret_cast<int8_t*>(words + 3 * kBlockLanes);
#pragma omp simd
  for (int i = 0; i < 3 * kBlockLanes; ++i) {
    words[i] = static_cast<uint16_t>(whole[i]);
  }
#pragma omp simd
  for (int i = 0; i < 2 * kBlockLanes; ++i) {
    bytes[i] = static_cast<int8_t>(octahedral[i]);
  }
}

void Deform(const DeformLayout& layout, float* __restrict out) {
  for (int r = 0; r < layout.run_count; ++r) {
    const VolumeRun& run = layout.runs[r];
    const VolumeCoefficients volume = layout.volumes[run.volume];
    for (int b = run.first_block; b < run.end_block; ++b) {
      const float* from = layout.vertices + int64_t{kBlockFloats} * b;
      float* to = out + int64_t{kBlockFloats} * b;
      // The hardware looks ahead on what is read, less so on what is written.
      for (int line = 0; line < kBlockRows; ++line) {
        __builtin_prefetch(to + kAhead * kBlockFloats + line * kBlockLanes, 1);
        __builtin_prefetch(from + kAhead * kBlockFloats + line * kBlockLanes);
      }
#pragma omp simd
      for (int lane = 0; lane < kBlockLanes; ++lane) {
        const Deformed vertex = DeformVertex(volume, from + lane);
        const float length2 = vertex.nx * vertex.nx + vertex.ny * vertex.ny +
                              vertex.nz * vertex.nz;
        const float inverse =
            1 / __builtin_sqrtf(length2 > 1e-30f ? length2 : 1e-30f);
        to[0 * kBlockLanes + lane] = vertex.x;
        to[1 * kBlockLanes + lane] = vertex.y;
        to[2 * kBlockLanes + lane] = vertex.z;
        to[3 * kBlockLanes + lane] = vertex.nx * inverse;
        to[4 * kBlockLanes + lane] = vertex.ny * inverse;
        to[5 * kBlockLanes + lane] = vertex.nz * inverse;
      }
    }
  }
}

void DeformQuantized(const DeformLayout& layout, const QuantizationGrid& grid,
                     uint8_t* __restrict out) {
  alignas(64) float block[kBlockFloats];
  for (int r = 0; r < layout.run_count; ++r) {
    const VolumeRun& run = layout.runs[r];
    const VolumeCoefficients volume = layout.volumes[run.volume];
    for (int b = run.first_block; b < run.end_block; ++b) {
      const float* from = layout.vertices + int64_t{kBlockFloats} * b;
#pragma omp simd
      for (int lane = 0; lane < kBlockLanes; ++lane) {
        const Deformed vertex = DeformVertex(volume, from + lane);
        block[0 * kBlockLanes + lane] = vertex.x;
        block[1 * kBlockLanes + lane] = vertex.y;
        block[2 * kBlockLanes + lane] = vertex.z;
        block[3 * kBlockLanes + lane] = vertex.nx;
        block[4 * kBlockLanes + lane] = vertex.ny;
        block[5 * kBlockLanes + lane] = vertex.nz;
      }
      QuantizeBlock(block, grid, out + int64_t{kQuantizedBlockBytes} * b);
    }
  }
}

void DeformParts(const DeformLayout& layout, float* __restrict out) {
  for (int r = 0; r < layout.run_count; ++r) {
    const VolumeRun& run = layout.runs[r];
    const VolumeCoefficients volume = layout.volumes[run.volume];
    for (int b = run.first_block; b < run.end_block; ++b) {
      const float* from =
          layout.vertices + int64_t{kPartRows} * kBlockLanes * b;
      float* to = out + int64_t{kPartSumRows} * kBlockLanes * b;
#pragma omp simd
      for (int lane = 0; lane < kBlockLanes; ++lane) {
        const float* in = from + lane;
        float p[9];
        float d[9];
        PlaneAt(volume, in[0], p, d);
        const float s = in[1 * kBlockLanes];
        const float t = in[2 * kBlockLanes];
        const float share = in[9 * kBlockLanes];
        for (int i = 0; i < 3; ++i) {
          const float f = p[i] + s * p[3 + i] + t * p[6 + i];
          const float f_u = d[i] + s * d[3 + i] + t * d[6 + i];
          const float first = f_u * in[3 * kBlockLanes] +
                              p[3 + i] * in[4 * kBlockLanes] +
                              p[6 + i] * in[5 * kBlockLanes];
          const float second = f_u * in[6 * kBlockLanes] +
                               p[3 + i] * in[7 * kBlockLanes] +
                               p[6 + i] * in[8 * kBlockLanes];
          to[i * kBlockLanes + lane] = share * f;
          to[(3 + i) * kBlockLanes + lane] =
              share * first + in[10 * kBlockLanes] * f;
          to[(6 + i) * kBlockLanes + lane] =
              share * second + in[11 * kBlockLanes] * f;
        }
      }
    }
  }
}

void Quantize(const float* blocks, int block_count,
              const QuantizationGrid& grid, uint8_t* out) {
  for (int b = 0; b < block_count; ++b) {
    QuantizeBlock(blocks + int64_t{kBlockFloats} * b, grid,
                  out + int64_t{kQuantizedBlockBytes} * b);
  }
}

}  // namespace

extern const DeformFunctions kDeform = {Deform, DeformQuantized, DeformParts,
                                        Quantize};

}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL
