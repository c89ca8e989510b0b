// Symmetric positive definite systems of a few unknowns, in registers.
//
// For the kernels only, like base/kernel/lanes.h.
#ifndef GELENK_IK_KERNEL_SMALL_SYSTEM_H_
#define GELENK_IK_KERNEL_SMALL_SYSTEM_H_

#include "gelenk/base/kernel/lanes.h"

namespace gelenk::kernel {
namespace {

// A = L D L^T with pivots of two by two: one division for two unknowns, and
// divisions are what one waits for. kCount systems side by side.
template <int kCount, int kSize>
struct SmallSystem {
  using Number = typename PackOf<kCount>::Pack;
  static constexpr int kPaired = kSize / 2 * 2;

  // The lower triangle of A; after Factorize L below the pivots, their inverses
  // on them.
  Number a[kSize][kSize];

  GELENK_INLINE void Clear() {
    for (int r = 0; r < kSize; ++r) {
      for (int c = 0; c <= r; ++c) a[r][c] = Number{};
    }
  }

  // A + damping * I.
  GELENK_INLINE void Factorize(Number damping) {
#pragma GCC unroll 8
    for (int b = 0; b < kPaired; b += 2) {
      const Number p = a[b][b] + damping;
      const Number q = a[b + 1][b + 1] + damping;
      const Number c = a[b + 1][b];
      const Number inverse = 1.0 / (p * q - c * c);
      a[b][b] = q * inverse;
      a[b + 1][b + 1] = p * inverse;
      a[b + 1][b] = -c * inverse;
      Eliminate(b);
    }
    if (kPaired < kSize) {
      a[kSize - 1][kSize - 1] = 1.0 / (a[kSize - 1][kSize - 1] + damping);
    }
  }

  // x = A^-1 x.
  GELENK_INLINE void Solve(Number* x) const {
#pragma GCC unroll 8
    for (int b = 0; b < kPaired; b += 2) {
#pragma GCC unroll 8
      for (int r = b + 2; r < kSize; ++r) {
        x[r] -= a[r][b] * x[b] + a[r][b + 1] * x[b + 1];
      }
    }
    if (kPaired < kSize) x[kSize - 1] *= a[kSize - 1][kSize - 1];
#pragma GCC unroll 8
    for (int b = kPaired - 2; b >= 0; b -= 2) {
      const Number x0 = x[b], x1 = x[b + 1];
      x[b] = a[b][b] * x0 + a[b + 1][b] * x1;
      x[b + 1] = a[b + 1][b] * x0 + a[b + 1][b + 1] * x1;
#pragma GCC unroll 8
      for (int r = b + 2; r < kSize; ++r) {
        x[b] -= a[r][b] * x[r];
        x[b + 1] -= a[r][b + 1] * x[r];
      }
    }
  }

 private:
  // Takes what the pivots at b explain off the rows below, and leaves L there.
  GELENK_INLINE void Eliminate(int b) {
    Number u0[kSize], u1[kSize];
#pragma GCC unroll 8
    for (int r = b + 2; r < kSize; ++r) {
      u0[r] = a[r][b];
      u1[r] = a[r][b + 1];
      a[r][b] = u0[r] * a[b][b] + u1[r] * a[b + 1][b];
      a[r][b + 1] = u0[r] * a[b + 1][b] + u1[r] * a[b + 1][b + 1];
#pragma GCC unroll 8
      for (int s = b + 2; s <= r; ++s) {
        a[r][s] -= a[r][b] * u0[s] + a[r][b + 1] * u1[s];
      }
    }
  }
};

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_SMALL_SYSTEM_H_
