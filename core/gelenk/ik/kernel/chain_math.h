// Small algebra of the kernel of chains: vectors and row-major matrices whose
// elements are packs, a number of each lane.
//
// For the kernels only, like base/kernel/lanes.h.
#ifndef GELENK_IK_KERNEL_CHAIN_MATH_H_
#define GELENK_IK_KERNEL_CHAIN_MATH_H_

#include "gelenk/base/kernel/lanes.h"

namespace gelenk::kernel {
namespace {

template <typename Pack>
GELENK_INLINE void Cross(const Pack* a, const Pack* b, Pack* out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}
template <typename Pack>
GELENK_INLINE Pack Dot(const Pack* a, const Pack* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <typename Pack>
GELENK_INLINE void Multiply(const Pack* a, const Pack* b, Pack* out) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      out[3 * i + j] =
          a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
    }
  }
}
template <typename Pack>
GELENK_INLINE void AddTransformed(const Pack* m, const Pack* v, Pack* out) {
  for (int i = 0; i < 3; ++i) {
    out[i] += m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
  }
}

template <typename Pack>
GELENK_INLINE void MatrixFromQuaternion(const Pack* q, Pack* m) {
  const Pack x2 = q[0] + q[0], y2 = q[1] + q[1], z2 = q[2] + q[2];
  const Pack xx = q[0] * x2, yy = q[1] * y2, zz = q[2] * z2;
  const Pack xy = q[0] * y2, xz = q[0] * z2, yz = q[1] * z2;
  const Pack wx = q[3] * x2, wy = q[3] * y2, wz = q[3] * z2;
  m[0] = 1 - (yy + zz), m[1] = xy - wz, m[2] = xz + wy;
  m[3] = xy + wz, m[4] = 1 - (xx + zz), m[5] = yz - wx;
  m[6] = xz - wy, m[7] = yz + wx, m[8] = 1 - (xx + yy);
}

// q * exp(w / 2), unit. `w` is at most sqrt(3) kMaxStep long, so that short
// series do: their error of 1e-10 shortens the step by as much, and what it
// takes from the norm is given back in second order.
template <typename Pack>
GELENK_INLINE void Rotate(const Pack* q, const Pack* w, Pack* out) {
  const Pack z = 0.25 * Dot(w, w);
  const Pack s =
      0.5 +
      z * (-1.0 / 12 +
           z * (1.0 / 240 +
                z * (-1.0 / 10080 +
                     z * (1.0 / 725760 +
                          z * (-1.0 / 79833600 + z * (1.0 / 12454041600))))));
  const Pack c =
      1 +
      z * (-1.0 / 2 +
           z * (1.0 / 24 +
                z * (-1.0 / 720 + z * (1.0 / 40320 +
                                       z * (-1.0 / 3628800 +
                                            z * (1.0 / 479001600 +
                                                 z * (-1.0 / 87178291200)))))));
  const Pack x = s * w[0], y = s * w[1], t = s * w[2];
  out[0] = q[3] * x + q[0] * c + q[1] * t - q[2] * y;
  out[1] = q[3] * y + q[1] * c + q[2] * x - q[0] * t;
  out[2] = q[3] * t + q[2] * c + q[0] * y - q[1] * x;
  out[3] = q[3] * c - q[0] * x - q[1] * y - q[2] * t;
  const Pack excess =
      out[0] * out[0] + out[1] * out[1] + out[2] * out[2] + out[3] * out[3] - 1;
  const Pack inverse = 1 + excess * (-0.5 + 0.375 * excess);
  for (int k = 0; k < 4; ++k) out[k] *= inverse;
}

GELENK_INLINE double AtLeast(double least, double value) {
  return value > least ? value : least;
}

// x = (m + damping)^-1 b for a positive semidefinite 3 x 3 matrix, its upper
// triangle by rows. No pivot can be below the damping but by rounding.
GELENK_INLINE void SolveDamped(const double* m, double damping, const double* b,
                               double* x) {
  const double r0 = 1 / (m[0] + damping);
  const double l1 = m[1] * r0, l2 = m[2] * r0;
  const double r1 = 1 / AtLeast(damping, m[3] + damping - l1 * m[1]);
  const double u = m[4] - l1 * m[2];
  const double l3 = u * r1;
  const double r2 = 1 / AtLeast(damping, m[5] + damping - l2 * m[2] - l3 * u);
  const double y1 = b[1] - l1 * b[0];
  const double y2 = b[2] - l2 * b[0] - l3 * y1;
  x[2] = y2 * r2;
  x[1] = y1 * r1 - l3 * x[2];
  x[0] = b[0] * r0 - l1 * x[1] - l2 * x[2];
}

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_CHAIN_MATH_H_
