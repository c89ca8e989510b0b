// The data that a NURBS surface is tessellated on at fixed parameters: plain
// arrays, compiled once per level of the instruction set.
//
// A tensor product in two stages: along v for each row of the net, then along
// u. Functions of v lie one row a function, so that columns go in vectors.
#ifndef GELENK_SKIN_KERNEL_TESSELLATE_LAYOUT_H_
#define GELENK_SKIN_KERNEL_TESSELLATE_LAYOUT_H_

#include "gelenk/skin/kernel/deform_layout.h"

namespace gelenk::kernel {

struct TessellateLayout {
  int net_rows;
  int net_columns;
  int degree_u;
  int degree_v;
  int rows;
  int columns;           // whole blocks
  const int* first_u;    // of each row: its first function
  const int* first_v;    // of each column
  const float* value_u;  // degree_u + 1 of each row
  const float* slope_u;
  const float* value_v;  // columns of each of degree_v + 1
  const float* slope_v;
};

// Sums along v of each net row: x y z w, then their slopes by v.
inline constexpr int kSumsPerColumn = 8;

// `net` holds w x, w y, w z, w of each point. `sums` is kSumsPerColumn *
// net_rows * columns. `out` as in DeformFunction, a row of columns / 16 blocks
// after the other.
using TessellateFunction = void (*)(const TessellateLayout& layout,
                                    const float* net, float* sums, float* out);

namespace baseline {
void Tessellate(const TessellateLayout&, const float*, float*, float*);
}
namespace avx2 {
void Tessellate(const TessellateLayout&, const float*, float*, float*);
}
namespace avx512 {
void Tessellate(const TessellateLayout&, const float*, float*, float*);
}

}  // namespace gelenk::kernel

#endif  // GELENK_SKIN_KERNEL_TESSELLATE_LAYOUT_H_
