// Sine and cosine of a number or of a vector of them, within 1 ulp: minimax
// polynomials of the Cephes library's kind on [-pi/4, pi/4], a three-part
// reduction.
//
// For the kernels only, see inline.h.
#ifndef GELENK_BASE_KERNEL_SINE_H_
#define GELENK_BASE_KERNEL_SINE_H_

#include "gelenk/base/kernel/inline.h"

namespace gelenk::kernel {
namespace {

// Beyond, the reduction loses digits.
constexpr double kLargestAngle = 1e5;

constexpr double kQuartersPerRadian = 6.36619772367581343076e-01;

// x - k * pi/2.
template <typename Number>
GELENK_INLINE Number TakeQuarters(const Number& x, const Number& k) {
  Number r = x - k * 1.57079632673412561417e+00;
  r -= k * 6.07710050630396597660e-11;
  r -= k * 2.02226624879595063154e-21;
  return r;
}

// The sine of r, z being its square.
template <typename Number>
GELENK_INLINE Number SinePolynomial(const Number& r, const Number& z) {
  return r + r * z *
                 (-1.66666666666666324348e-01 +
                  z * (8.33333333332248946124e-03 +
                       z * (-1.98412698298579493134e-04 +
                            z * (2.75573137070700676789e-06 +
                                 z * (-2.50507602534068634195e-08 +
                                      z * 1.58969099521155010221e-10)))));
}

// The cosine of a number whose square is z.
template <typename Number>
GELENK_INLINE Number CosinePolynomial(const Number& z) {
  return 1.0 - 0.5 * z +
         z * z *
             (4.16666666666666019037e-02 +
              z * (-1.38888888888741095749e-03 +
                   z * (2.48015872894767294178e-05 +
                        z * (-2.75573143513906633035e-07 +
                             z * (2.08757232129817482790e-09 +
                                  z * -1.13596475577881948265e-11)))));
}

// Of one number; beyond kLargestAngle the compiler's own.
GELENK_INLINE void SineCosine(double x, double* sine, double* cosine) {
  if ((x < 0 ? -x : x) > kLargestAngle) {
    *sine = __builtin_sin(x);
    *cosine = __builtin_cos(x);
    return;
  }
  const double k = __builtin_rint(x * kQuartersPerRadian);
  const double r = TakeQuarters(x, k);
  const double z = r * r;
  const double s = SinePolynomial(r, z);
  const double c = CosinePolynomial(z);
  const int quadrant = static_cast<int>(k) & 3;
  const double a = (quadrant & 1) ? c : s;
  const double b = (quadrant & 1) ? s : c;
  *sine = (quadrant & 2) ? -a : a;
  *cosine = ((quadrant + 1) & 2) ? -b : b;
}

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_BASE_KERNEL_SINE_H_
