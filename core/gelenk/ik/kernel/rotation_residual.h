// The rotation part of a residual where its usual form has no digits left.
//
// For the kernels only, like base/kernel/lanes.h.
#ifndef GELENK_IK_KERNEL_ROTATION_RESIDUAL_H_
#define GELENK_IK_KERNEL_ROTATION_RESIDUAL_H_

#include "gelenk/base/kernel/lanes.h"

namespace gelenk::kernel {
namespace {

// Of 1 + trace = 4 cos^2(angle / 2): below it the rotation is near half a turn
// and its axis is no longer seen in the skew part.
constexpr double kNearHalfTurn = 1e-3;

// e = 2 sin(angle / 2) * axis of the rotation d, row-major, near half a turn:
// the axis comes from the largest diagonal element.
GELENK_INLINE void HalfTurnResidual(const double* d, double* e) {
  const int i = d[0] >= d[4] && d[0] >= d[8] ? 0 : (d[4] >= d[8] ? 1 : 2);
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  const double square = 1 + d[4 * i] - d[4 * j] - d[4 * k];
  const double root =
      __builtin_sqrt(square > 0 ? square : 0);  // 2 |component i|
  const double sign = d[3 * k + j] < d[3 * j + k] ? -1 : 1;
  e[i] = sign * root;
  e[j] = sign * (d[3 * i + j] + d[3 * j + i]) / root;
  e[k] = sign * (d[3 * i + k] + d[3 * k + i]) / root;
}

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_ROTATION_RESIDUAL_H_
