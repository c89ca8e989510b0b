// One step of one priority level: a least-squares problem in the directions
// that the levels above leave free, within bounds.
//
//   minimise  |J x - e|^2 / 2 + sum of D_i x_i^2 / 2 - p . x
//   where     A x = 0   of some rows, as far as A's rank goes
//             A x >= c  of the others, c <= 0
//             lower <= x <= upper, lower <= 0 <= upper
//
// D (> 0) is damping and posture; x the change of each degree of freedom, A the
// levels above, J this level. A row of J may be one-sided: it counts only where
// J x < e, as that of a half-space does.
//
// Bounds are found by blocks: all that a step breaks are held, all that pull
// inwards let go, until neither is left (Kunisch and Rendl, SIAM J. Optim.
// 14(1), 2003). Where that does not settle, a primal active-set method from
// x = 0, which satisfies everything, goes on until a bound stands in the way
// and is held there (Nocedal and Wright, Numerical Optimization, 2006, ch. 16).
// In between, A is factorised in the metric of D (see NullSpace), so that the
// rest of the problem has no more unknowns than this level has rows, however
// large the skeleton is.
//
// Cost of a round: 2 n m^2 for n degrees of freedom and m rows of A, and
// n k (4 m + k) + k^3 / 3 for k rows of J; a warm step takes one round or two.
// Keeps its memory: a problem no larger than an earlier one allocates nothing.
// Not thread-safe.
#ifndef GELENK_IK_LEVEL_STEP_H_
#define GELENK_IK_LEVEL_STEP_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gelenk/ik/null_space.h"

namespace gelenk {

class LevelStep {
 public:
  using MatrixView = Eigen::Map<
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
  using ConstVectorMap = Eigen::Map<const Eigen::VectorXd>;

  // For `column_count` degrees of freedom, up to `constraint_count` rows of A
  // and up to `row_count` of J. Forgets what was there.
  void Reserve(int column_count, int constraint_count, int row_count);

  // Forgets what the last Solve held: answers depend on nothing before it.
  void ForgetHolds();

  // Adds rows to A, zero until the caller fills them in; `at_least` or equal.
  MatrixView AddConstraints(int count, bool at_least);
  int constraint_count() const { return constraint_count_; }
  void SetConstraint(int row, double c) { c_[row] = c; }
  // All rows of A, and of J.
  MatrixView constraints() {
    return MatrixView(a_.data(), constraint_count_, column_count_);
  }
  MatrixView rows() { return MatrixView(j_.data(), row_count_, column_count_); }

  // The same for J.
  MatrixView AddRows(int count);
  int row_count() const { return row_count_; }
  void SetRow(int row, double e) { e_[row] = e; }
  // Starts as one that counts if `counts`.
  void SetOneSided(int row, bool counts) {
    one_sided_[row] = 1;
    counts_[row] = counts ? 1 : 0;
  }
  // After Solve.
  bool Counts(int row) const { return counts_[row] != 0; }

  void SetColumn(int column, double diagonal, double pull) {
    diagonal_[column] = diagonal;
    pull_[column] = pull;
  }
  void SetBounds(int column, double lower, double upper) {
    lower_[column] = lower;
    upper_[column] = upper;
  }

  // For bounds that are near everywhere: a step that goes far out of them would
  // end in a corner, and take long to find which. Asks for a part of it
  // instead.
  void SetShortensWish(bool shortens) { shortens_wish_ = shortens; }

  // False when the active set was still changing after many rounds; the step is
  // inside its bounds all the same. Of what the last Solve held of columns that
  // have not moved since, it starts from.
  bool Solve();

  // The same where c may be anything, also of the equations; only by blocks.
  // False, and no step, where they did not find one.
  bool SolveConstraints();

  ConstVectorMap step() const { return {step_.data(), column_count_}; }
  // By how much the objective falls, if J is right.
  double gain() const { return gain_; }
  // The strongest push against a bound at x = 0, and the strongest pull on what
  // is free to move.
  double bound_force() const { return bound_force_; }
  double free_force() const { return free_force_; }

  // The least x, in the metric of D and of what the last Solve left free, for
  // which A x has these values on the rows that hold; `values` by row of A.
  void Correct(const double* values, double* x);

 private:
  enum class Hold : uint8_t { kFree, kLower, kUpper };

  void StartActiveSet();
  // False when it did not settle.
  bool SolveByBlocks();
  void ShortenWish();
  // Lets columns go without which the rows cannot hold; false when they do.
  bool ReleaseForRows();
  // Holds what the step breaks; false when that is nothing.
  bool HoldViolated();
  // The best move with what is held, from the step so far; brings the rows that
  // hold to their values.
  void SolveActiveSet();
  void SolveRows();
  // Makes the move, up to the first bound in its way, which then holds; false
  // when there was none.
  bool MoveToFirstBound();
  // Lets go what pulls inwards; false when nothing does.
  bool DropWrong();
  // Lets one-sided rows count where they should; false when all do.
  bool FlipOneSided();
  void ComputeMultipliers();
  void MeasureForces();

  const double* A(int row) const {
    return a_.data() + static_cast<size_t>(row) * column_count_;
  }
  const double* J(int row) const {
    return j_.data() + static_cast<size_t>(row) * column_count_;
  }

  int column_count_ = 0;
  int constraint_count_ = 0;
  int row_count_ = 0;
  bool shortens_wish_ = false;
  // The problem.
  std::vector<double> a_, c_, j_, e_;
  std::vector<uint8_t> at_least_, one_sided_, counts_;
  std::vector<double> diagonal_, pull_, lower_, upper_;
  // The active set, and how often a member of it was let go.
  std::vector<Hold> holds_;
  std::vector<uint8_t> active_;
  std::vector<int> drops_;
  // D^-1/2, 0 where a column is held.
  std::vector<double> scale_;
  NullSpace null_space_;
  // Work.
  std::vector<double> turned_;  // J D^-1/2 Q
  std::vector<double> small_;   // of rows by rows
  std::vector<double> rest_, z_, room_, speed_;
  std::vector<double> misses_;    // J x - e
  std::vector<double> gradient_;  // of the objective, then of the Lagrangian
  std::vector<double> multipliers_;
  std::vector<double> step_, move_;
  double gain_ = 0;
  double bound_force_ = 0;
  double free_force_ = 0;
};

}  // namespace gelenk

#endif  // GELENK_IK_LEVEL_STEP_H_
