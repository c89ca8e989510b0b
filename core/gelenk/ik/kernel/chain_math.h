// Small algebra of the kernel of chains' step.
//
// For the kernels only, like base/kernel/lanes.h.
#ifndef GELENK_IK_KERNEL_CHAIN_MATH_H_
#define GELENK_IK_KERNEL_CHAIN_MATH_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/ik/kernel/spatial_math.h"

namespace gelenk::kernel {
namespace {

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
  const Pack turn[4] = {s * w[0], s * w[1], s * w[2], c};
  MultiplyQuaternions(q, turn, out);
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
