// Small algebra of single numbers, where std's functions must not be used.
//
// For the kernels only, see inline.h.
#ifndef GELENK_BASE_KERNEL_SCALAR_H_
#define GELENK_BASE_KERNEL_SCALAR_H_

#include "gelenk/base/kernel/inline.h"

namespace gelenk::kernel {
namespace {

GELENK_INLINE double Min(double a, double b) { return a < b ? a : b; }
GELENK_INLINE double Max(double a, double b) { return a > b ? a : b; }
GELENK_INLINE double Abs(double a) { return a < 0 ? -a : a; }

GELENK_INLINE void Copy(const double* from, double* to, int count) {
  for (int i = 0; i < count; ++i) to[i] = from[i];
}

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_BASE_KERNEL_SCALAR_H_
