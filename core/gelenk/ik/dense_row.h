// Loops over rows of numbers that are as long as a skeleton has degrees of
// freedom: what small dense algebra spends its time in.
#ifndef GELENK_IK_DENSE_ROW_H_
#define GELENK_IK_DENSE_ROW_H_

namespace gelenk {

inline double Dot(const double* a, const double* b, int count) {
  // Four sums, so that the compiler may keep them side by side.
  double sums[4] = {};
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    for (int k = 0; k < 4; ++k) sums[k] += a[i + k] * b[i + k];
  }
  for (; i < count; ++i) sums[0] += a[i] * b[i];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

// b <- b + factor a
inline void AddScaled(double factor, const double* a, double* b, int count) {
  for (int i = 0; i < count; ++i) b[i] += factor * a[i];
}

}  // namespace gelenk

#endif  // GELENK_IK_DENSE_ROW_H_
