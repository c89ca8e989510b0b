// How the sources that are compiled once per level of the instruction set (see
// gelenk_kernel_level in CMakeLists.txt) mark their functions.
//
// What they share is in unnamed namespaces and always inlined: a function that
// was emitted with a higher level could be picked by the linker for everybody.
// For the same reason such sources use nothing of a library.
#ifndef GELENK_BASE_KERNEL_INLINE_H_
#define GELENK_BASE_KERNEL_INLINE_H_

#define GELENK_INLINE inline __attribute__((always_inline))

#endif  // GELENK_BASE_KERNEL_INLINE_H_
