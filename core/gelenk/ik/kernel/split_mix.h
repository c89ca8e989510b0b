// Random numbers that are the same on every machine: SplitMix64 (Steele, Lea,
// Flood, "Fast splittable pseudorandom number generators", 2014).
//
// Inline everywhere and of no library, so that kernels may use it.
#ifndef GELENK_IK_KERNEL_SPLIT_MIX_H_
#define GELENK_IK_KERNEL_SPLIT_MIX_H_

#include <cstdint>

namespace gelenk::kernel {
namespace {

// Uniform in [lower, upper); moves `state` on.
inline __attribute__((always_inline)) double NextUniform(uint64_t& state,
                                                         double lower,
                                                         double upper) {
  state += 0x9E3779B97F4A7C15u;
  uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  z ^= z >> 31;
  const double unit = static_cast<double>(z >> 11) * 0x1p-53;
  return lower + (upper - lower) * unit;
}

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_SPLIT_MIX_H_
