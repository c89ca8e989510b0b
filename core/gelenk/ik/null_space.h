// The directions that leave some linear forms as they are, in a metric.
//
// For rows A and a scale S of the columns: (A S)^T P = Q R by Householder's
// method with column pivoting (Golub and Van Loan, Matrix Computations, 2013,
// 5.4.2). S Q y leaves the forms as they are when the first `rank` numbers of y
// are 0, and is as long in the metric S^-2 as y is.
//
// Plain arrays, row-major. Cost: 2 n m r for n columns, m rows of rank r. Keeps
// its memory: no more columns and rows than before allocate nothing. Not
// thread-safe.
#ifndef GELENK_IK_NULL_SPACE_H_
#define GELENK_IK_NULL_SPACE_H_

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gelenk {

class NullSpace {
 public:
  void Reserve(int column_count, int row_count);

  // Of those rows of `a` for which `active` is not 0.
  void Factorize(const double* a, int row_count, const uint8_t* active,
                 const double* scale);

  int rank() const { return rank_; }
  // v <- Q^T v and v <- Q v.
  void ApplyTransposed(double* v) const;
  void Apply(double* v) const;

  // The first `rank` numbers of `z` such that A S Q z has `values` (by row) on
  // the rows that made up the rank.
  void SolveForms(const double* values, double* z) const;
  // `multipliers` (by row, 0 for rows that add nothing) such that
  // Q^T (A S)^T multipliers has the first `rank` numbers of `z`, which it
  // destroys.
  void SolveMultipliers(double* z, double* multipliers) const;

 private:
  const double* Factor(int k) const {
    return factors_.data() + static_cast<size_t>(k) * column_count_;
  }
  double* Factor(int k) {
    return factors_.data() + static_cast<size_t>(k) * column_count_;
  }
  void Reflect(const double* v, int k, double* other) const;

  int column_count_ = 0;
  int row_count_ = 0;
  int rank_ = 0;
  // Per pivot a Householder vector from its own place on, and R before it.
  std::vector<double> factors_;
  std::vector<double> diagonal_, taus_, norms2_;
  std::vector<int> rows_;  // by pivot
};

}  // namespace gelenk

#endif  // GELENK_IK_NULL_SPACE_H_
