// NURBS at fixed parameters, compiled once per level of the instruction set.
#include "gelenk/base/kernel/lanes.h"
#include "gelenk/skin/kernel/tessellate_layout.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

GELENK_INLINE void SumAlongV(const TessellateLayout& layout, const float* net,
                             float* __restrict sums) {
  for (int i = 0; i < layout.net_rows; ++i) {
    const float* row = net + 4 * int64_t{layout.net_columns} * i;
    float* to = sums + int64_t{kSumsPerColumn} * layout.columns * i;
    for (int j = 0; j < layout.columns; ++j) {
      float value[4] = {};
      float slope[4] = {};
      for (int l = 0; l <= layout.degree_v; ++l) {
        const float b = layout.value_v[l * layout.columns + j];
        const float d = layout.slope_v[l * layout.columns + j];
        const float* point = row + 4 * (layout.first_v[j] + l);
        for (int c = 0; c < 4; ++c) {
          value[c] += b * point[c];
          slope[c] += d * point[c];
        }
      }
      for (int c = 0; c < 4; ++c) {
        to[c * layout.columns + j] = value[c];
        to[(4 + c) * layout.columns + j] = slope[c];
      }
    }
  }
}

// Sixteen columns of one row, from `first` on.
GELENK_INLINE void SumAlongU(const TessellateLayout& layout, const float* sums,
                             int row, int first, float* __restrict out) {
  // Values, slopes by v; slopes by u.
  float sum[kSumsPerColumn][kBlockLanes] = {};
  float by_u[4][kBlockLanes] = {};
  for (int l = 0; l <= layout.degree_u; ++l) {
    const float b = layout.value_u[row * (layout.degree_u + 1) + l];
    const float d = layout.slope_u[row * (layout.degree_u + 1) + l];
    const float* from =
        sums +
        int64_t{kSumsPerColumn} * layout.columns * (layout.first_u[row] + l) +
        first;
    for (int c = 0; c < kSumsPerColumn; ++c) {
#pragma omp simd
      for (int k = 0; k < kBlockLanes; ++k) {
        sum[c][k] += b * from[c * layout.columns + k];
      }
    }
    for (int c = 0; c < 4; ++c) {
#pragma omp simd
      for (int k = 0; k < kBlockLanes; ++k) {
        by_u[c][k] += d * from[c * layout.columns + k];
      }
    }
  }
#pragma omp simd
  for (int k = 0; k < kBlockLanes; ++k) {
    const float inverse = 1 / sum[3][k];
    const float x = sum[0][k] * inverse;
    const float y = sum[1][k] * inverse;
    const float z = sum[2][k] * inverse;
    const float ux = by_u[0][k] - by_u[3][k] * x;
    const float uy = by_u[1][k] - by_u[3][k] * y;
    const float uz = by_u[2][k] - by_u[3][k] * z;
    const float vx = sum[4][k] - sum[7][k] * x;
    const float vy = sum[5][k] - sum[7][k] * y;
    const float vz = sum[6][k] - sum[7][k] * z;
    const float nx = uy * vz - uz * vy;
    const float ny = uz * vx - ux * vz;
    const float nz = ux * vy - uy * vx;
    const float length2 = nx * nx + ny * ny + nz * nz;
    const float scale =
        1 / __builtin_sqrtf(length2 > 1e-30f ? length2 : 1e-30f);
    out[0 * kBlockLanes + k] = x;
    out[1 * kBlockLanes + k] = y;
    out[2 * kBlockLanes + k] = z;
    out[3 * kBlockLanes + k] = nx * scale;
    out[4 * kBlockLanes + k] = ny * scale;
    out[5 * kBlockLanes + k] = nz * scale;
  }
}

}  // namespace

void Tessellate(const TessellateLayout& layout, const float* net, float* sums,
                float* out) {
  SumAlongV(layout, net, sums);
  for (int row = 0; row < layout.rows; ++row) {
    for (int first = 0; first < layout.columns; first += kBlockLanes) {
      const int64_t block =
          (int64_t{layout.columns} * row + first) / kBlockLanes;
      SumAlongU(layout, sums, row, first, out + kBlockFloats * block);
    }
  }
}

}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL
