#include "gelenk/ik/null_space.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "gelenk/ik/dense_row.h"

namespace gelenk {
namespace {

// A form counts where it has more than this part of the largest one's length
// left at right angles to the others.
constexpr double kRankCutoff = 1e-6;
// A squared norm that was taken down to this part of what it was is rounding,
// and computed anew.
constexpr double kStaleNorm = 1e-4;

}  // namespace

void NullSpace::Reserve(int column_count, int row_count) {
  column_count_ = column_count;
  const size_t rows = row_count;
  if (rows_.size() < rows) {
    diagonal_.resize(rows);
    taus_.resize(rows);
    norms2_.resize(rows);
    rows_.resize(rows);
  }
  const size_t numbers = rows * column_count;
  if (factors_.size() < numbers) factors_.resize(numbers);
}

void NullSpace::Factorize(const double* a, int row_count, const uint8_t* active,
                          const double* scale) {
  const int n = column_count_;
  row_count_ = row_count;
  int count = 0;
  for (int r = 0; r < row_count; ++r) {
    if (active[r] == 0) continue;
    double* v = Factor(count);
    const double* row = a + static_cast<size_t>(r) * n;
    for (int i = 0; i < n; ++i) v[i] = row[i] * scale[i];
    norms2_[count] = Dot(v, v, n);
    rows_[count++] = r;
  }
  rank_ = 0;
  double largest = 0;
  for (int k = 0; k < std::min(n, count); ++k) {
    const int pivot = static_cast<int>(
        std::max_element(norms2_.begin() + k, norms2_.begin() + count) -
        norms2_.begin());
    double* v = Factor(k);
    if (pivot != k) {
      std::swap_ranges(v, v + n, Factor(pivot));
      std::swap(rows_[k], rows_[pivot]);
      norms2_[pivot] = norms2_[k];
    }
    const double norm = std::sqrt(Dot(v + k, v + k, n - k));
    if (k == 0) largest = norm;
    if (!(norm > kRankCutoff * largest)) return;
    diagonal_[k] = v[k] > 0 ? -norm : norm;
    v[k] -= diagonal_[k];
    // |v|^2 = 2 norm (norm + |v_k|).
    taus_[k] = 1 / (norm * std::abs(v[k]));
    for (int r = k + 1; r < count; ++r) {
      double* other = Factor(r);
      Reflect(v, k, other);
      const double left2 = norms2_[r] - other[k] * other[k];
      norms2_[r] = left2 > kStaleNorm * norms2_[r]
                       ? left2
                       : Dot(other + k + 1, other + k + 1, n - k - 1);
    }
    ++rank_;
  }
}

void NullSpace::Reflect(const double* v, int k, double* other) const {
  const int left = column_count_ - k;
  const double along = taus_[k] * Dot(v + k, other + k, left);
  AddScaled(-along, v + k, other + k, left);
}

void NullSpace::ApplyTransposed(double* v) const {
  for (int k = 0; k < rank_; ++k) Reflect(Factor(k), k, v);
}

void NullSpace::Apply(double* v) const {
  for (int k = rank_ - 1; k >= 0; --k) Reflect(Factor(k), k, v);
}

void NullSpace::SolveForms(const double* values, double* z) const {
  for (int k = 0; k < rank_; ++k) {
    z[k] = (values[rows_[k]] - Dot(Factor(k), z, k)) / diagonal_[k];
  }
}

void NullSpace::SolveMultipliers(double* z, double* multipliers) const {
  std::fill_n(multipliers, row_count_, 0.0);
  for (int k = rank_ - 1; k >= 0; --k) {
    const double value = z[k] / diagonal_[k];
    multipliers[rows_[k]] = value;
    AddScaled(-value, Factor(k), z, k);
  }
}

}  // namespace gelenk
