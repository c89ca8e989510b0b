// Vectors and small matrices between the world and the frames of a chain's
// segments, and the sums that J S^-1 J^T is made of.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_CHAIN_FRAMES_H_
#define GELENK_IK_KERNEL_CHAIN_FRAMES_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/chain_layout.h"
#include "gelenk/ik/kernel/chain_state.h"
#include "gelenk/ik/kernel/spatial_math.h"
#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// A world vector, one for all or one for each, in the frames of the segments.
template <typename Number>
GELENK_INLINE void ToSegments(const ChainState& state, const Number* v,
                              int part, Pack* out) {
  for (int k = 0; k < 3; ++k) {
    out[k] = Get(state.base_rotation, k, part) * v[0] +
             Get(state.base_rotation, 3 + k, part) * v[1] +
             Get(state.base_rotation, 6 + k, part) * v[2];
  }
}

GELENK_INLINE void TipInSegments(const ChainState& state, int part, Pack* out) {
  Pack way[3];
  for (int k = 0; k < 3; ++k) way[k] = state.tip[k] - Get(state.base, k, part);
  ToSegments(state, way, part, out);
}

// m += j weight j^T; upper triangle.
GELENK_INLINE void Accumulate(const Pack* j, const Pack& weight, Pack* m) {
  const Pack x = weight * j[0], y = weight * j[1], z = weight * j[2];
  m[0] += x * j[0], m[1] += x * j[1], m[2] += x * j[2];
  m[3] += y * j[1], m[4] += y * j[2];
  m[5] += z * j[2];
}

// sum += B m B^T for the segments' B; upper triangles.
GELENK_INLINE void AddToWorld(const ChainState& state, const Pack* m, int part,
                              Pack* sum) {
  Pack b[9], half[9];
  for (int k = 0; k < 9; ++k) b[k] = Get(state.base_rotation, k, part);
  const Pack full[9] = {m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5]};
  Multiply(b, full, half);
  int at = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) sum[at++] += Dot(half + 3 * i, b + 3 * j);
  }
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_CHAIN_FRAMES_H_
