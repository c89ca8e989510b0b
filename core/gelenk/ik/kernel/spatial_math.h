// Small algebra of space: vectors, row-major matrices and quaternions (x y z w)
// whose elements are numbers, or packs with a number of each lane.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_SPATIAL_MATH_H_
#define GELENK_IK_KERNEL_SPATIAL_MATH_H_

#include "gelenk/base/kernel/inline.h"

namespace gelenk::kernel {
namespace {

template <typename Number>
GELENK_INLINE void Cross(const Number* a, const Number* b, Number* out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}
template <typename Number>
GELENK_INLINE Number Dot(const Number* a, const Number* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <typename Number>
GELENK_INLINE void Multiply(const Number* a, const Number* b, Number* out) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      out[3 * i + j] =
          a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
    }
  }
}
template <typename Number>
GELENK_INLINE void AddTransformed(const Number* m, const Number* v,
                                  Number* out) {
  for (int i = 0; i < 3; ++i) {
    out[i] += m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
  }
}

template <typename Number>
GELENK_INLINE void MatrixFromQuaternion(const Number* q, Number* m) {
  const Number x2 = q[0] + q[0], y2 = q[1] + q[1], z2 = q[2] + q[2];
  const Number xx = q[0] * x2, yy = q[1] * y2, zz = q[2] * z2;
  const Number xy = q[0] * y2, xz = q[0] * z2, yz = q[1] * z2;
  const Number wx = q[3] * x2, wy = q[3] * y2, wz = q[3] * z2;
  m[0] = 1 - (yy + zz), m[1] = xy - wz, m[2] = xz + wy;
  m[3] = xy + wz, m[4] = 1 - (xx + zz), m[5] = yz - wx;
  m[6] = xz - wy, m[7] = yz + wx, m[8] = 1 - (xx + yy);
}

template <typename Number>
GELENK_INLINE void MultiplyQuaternions(const Number* a, const Number* b,
                                       Number* out) {
  out[0] = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
  out[1] = a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2];
  out[2] = a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0];
  out[3] = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
}

// point + rotation * v
GELENK_INLINE void Transform(const double* rotation, const double* point,
                             const double* v, double* out) {
  for (int i = 0; i < 3; ++i) {
    out[i] = point[i] + rotation[3 * i] * v[0] + rotation[3 * i + 1] * v[1] +
             rotation[3 * i + 2] * v[2];
  }
}

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_SPATIAL_MATH_H_
