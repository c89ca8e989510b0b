// Vectors of doubles, for the sources that are compiled once per level of the
// instruction set (see gelenk_kernel_level in CMakeLists.txt).
//
// For the kernels only, see inline.h.
#ifndef GELENK_BASE_KERNEL_LANES_H_
#define GELENK_BASE_KERNEL_LANES_H_

#include <cstdint>

#include "gelenk/base/kernel/inline.h"
#include "gelenk/base/kernel/sine.h"

namespace gelenk::kernel {
namespace {

// Spelled out: the attribute takes no template parameter.
template <int kCount>
struct PackOf;
template <>
struct PackOf<1> {
  typedef double Pack;
};
template <>
struct PackOf<2> {
  typedef double Pack __attribute__((vector_size(16), may_alias));
  typedef int64_t Mask __attribute__((vector_size(16), may_alias));
  static GELENK_INLINE Pack Gather(const double* from, const int* at) {
    return Pack{from[at[0]], from[at[1]]};
  }
  static GELENK_INLINE double Sum(const Pack& a) { return a[0] + a[1]; }
  static GELENK_INLINE double Largest(const Pack& a) {
    return a[0] > a[1] ? a[0] : a[1];
  }
};
template <>
struct PackOf<4> {
  typedef double Pack __attribute__((vector_size(32), may_alias));
  typedef int64_t Mask __attribute__((vector_size(32), may_alias));
  static GELENK_INLINE Pack Gather(const double* from, const int* at) {
    return Pack{from[at[0]], from[at[1]], from[at[2]], from[at[3]]};
  }
  static GELENK_INLINE double Sum(const Pack& a) {
    return PackOf<2>::Sum(__builtin_shufflevector(a, a, 0, 1) +
                          __builtin_shufflevector(a, a, 2, 3));
  }
  static GELENK_INLINE double Largest(const Pack& a) {
    const PackOf<2>::Pack low = __builtin_shufflevector(a, a, 0, 1);
    const PackOf<2>::Pack high = __builtin_shufflevector(a, a, 2, 3);
    return PackOf<2>::Largest(low > high ? low : high);
  }
};
template <>
struct PackOf<8> {
  typedef double Pack __attribute__((vector_size(64), may_alias));
  typedef int64_t Mask __attribute__((vector_size(64), may_alias));
  static GELENK_INLINE Pack Gather(const double* from, const int* at) {
    return Pack{from[at[0]], from[at[1]], from[at[2]], from[at[3]],
                from[at[4]], from[at[5]], from[at[6]], from[at[7]]};
  }
  static GELENK_INLINE double Sum(const Pack& a) {
    return PackOf<4>::Sum(__builtin_shufflevector(a, a, 0, 1, 2, 3) +
                          __builtin_shufflevector(a, a, 4, 5, 6, 7));
  }
  static GELENK_INLINE double Largest(const Pack& a) {
    const PackOf<4>::Pack low = __builtin_shufflevector(a, a, 0, 1, 2, 3);
    const PackOf<4>::Pack high = __builtin_shufflevector(a, a, 4, 5, 6, 7);
    return PackOf<4>::Largest(low > high ? low : high);
  }
};

template <int kCount>
struct Lanes : PackOf<kCount> {
  using Pack = typename PackOf<kCount>::Pack;
  using Mask = typename PackOf<kCount>::Mask;

  static GELENK_INLINE Pack Load(const double* from) {
    return *reinterpret_cast<const Pack*>(from);
  }
  static GELENK_INLINE void Store(const Pack& pack, double* to) {
    *reinterpret_cast<Pack*>(to) = pack;
  }
  static GELENK_INLINE Pack All(double value) { return value - Pack{}; }
  // Where the processor cannot compare whole 64-bit numbers, the language's own
  // choice between packs becomes branches.
  static GELENK_INLINE Pack Select(const Mask& mask, const Pack& a,
                                   const Pack& b) {
#if defined(__SSE4_1__)
    return mask ? a : b;
#else
    return (Pack)((mask & (Mask)a) | (~mask & (Mask)b));
#endif
  }
  static GELENK_INLINE Pack Min(const Pack& a, const Pack& b) {
    return a < b ? a : b;
  }
  static GELENK_INLINE Pack Max(const Pack& a, const Pack& b) {
    return a > b ? a : b;
  }
  static GELENK_INLINE Pack SquareRoot(const Pack& a) {
    Pack root;
    for (int i = 0; i < kCount; ++i) root[i] = __builtin_sqrt(a[i]);
    return root;
  }
  static GELENK_INLINE Pack Abs(const Pack& a) { return Max(a, -a); }
  // One bit a lane, set where the lane's sign is.
  static GELENK_INLINE unsigned Bits(const Mask& mask) {
#if defined(__AVX512DQ__)
    if constexpr (kCount == 8) {
      typedef long long Signs __attribute__((vector_size(64)));
      return static_cast<unsigned char>(
          __builtin_ia32_cvtq2mask512((Signs)mask));
    }
#endif
#if defined(__AVX__)
    if constexpr (kCount == 4) {
      typedef double Signs __attribute__((vector_size(32)));
      return __builtin_ia32_movmskpd256((Signs)mask);
    }
#endif
#if defined(__SSE2__)
    if constexpr (kCount == 2) {
      typedef double Signs __attribute__((vector_size(16)));
      return __builtin_ia32_movmskpd((Signs)mask);
    }
#endif
    // Through memory: g++ 12 under UBSan forgets the index into a vector that
    // the processor does not have.
    int64_t signs[kCount];
    *reinterpret_cast<Mask*>(signs) = mask;
    unsigned bits = 0;
    for (int i = 0; i < kCount; ++i) bits |= (signs[i] < 0 ? 1u : 0u) << i;
    return bits;
  }

  // Of |x| <= kLargestAngle; see sine.h.
  static GELENK_INLINE void SineCosine(const Pack& x, Pack* sine,
                                       Pack* cosine) {
    // Adding 1.5 * 2^52 rounds to a whole number, which is then in the low
    // bits.
    constexpr double kRounder = 6755399441055744.0;
    const Pack rounded = x * kQuartersPerRadian + kRounder;
    const Pack k = rounded - kRounder;
    const Pack r = TakeQuarters(x, k);
    const Pack z = r * r;
    const Pack s = SinePolynomial(r, z);
    const Pack c = CosinePolynomial(z);
    const Mask quadrant = (Mask)rounded;
    const Mask odd = -(quadrant & 1);
    const Pack a = Select(odd, c, s);
    const Pack b = Select(odd, s, c);
    // Bit 1 of the quadrant, and of the next one, moved to the sign.
    const Mask sine_sign = (quadrant & 2) << 62;
    const Mask cosine_sign = ((quadrant + 1) & 2) << 62;
    *sine = (Pack)((Mask)a ^ sine_sign);
    *cosine = (Pack)((Mask)b ^ cosine_sign);
  }
};

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_BASE_KERNEL_LANES_H_
