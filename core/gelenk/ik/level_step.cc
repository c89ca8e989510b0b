#include "gelenk/ik/level_step.h"

#include <algorithm>
#include <cmath>

#include "gelenk/ik/dense_row.h"

namespace gelenk {
namespace {

// Most active sets are found in fewer block rounds; one at a time they settle
// within as many again as there are bounds in the way.
constexpr int kBlockRounds = 12;
constexpr int kMaxRounds = 40;
// Something let go this often stays held: the rest is rounding.
constexpr int kMaxDrops = 2;
// A bound this near is reached. Rad or m.
constexpr double kFeasible = 1e-14;
// In whole ranges of a column: what wishes for more is only told by the way.
constexpr double kOverreach = 0.7;
// A row of A that is off by no more holds.
constexpr double kHolds = 1e-10;
// Columns that are held and would help by this part of what the best one would
// are let go together.
constexpr double kHelps = 0.5;
// Of the forces' size: less is rounding.
constexpr double kWrongSign = 1e-9;
// Of a one-sided row, beyond which it is on the wrong side; weighted m.
constexpr double kWrongSide = 1e-12;
// A one-sided row that pulls back, and gets less than all but this part.
constexpr double kOutweighed = 0.05;

template <class Number>
void Grow(std::vector<Number>& numbers, size_t count) {
  if (numbers.size() < count) numbers.resize(count);
}

// L L^T = K in the lower triangle of `k`, row-major.
void Cholesky(double* k, int size) {
  for (int i = 0; i < size; ++i) {
    double* row = k + static_cast<size_t>(i) * size;
    for (int j = 0; j <= i; ++j) {
      const double* other = k + static_cast<size_t>(j) * size;
      const double value = row[j] - Dot(row, other, j);
      row[j] = i == j ? std::sqrt(value) : value / other[j];
    }
  }
}

void SolveCholesky(const double* k, int size, double* b) {
  for (int i = 0; i < size; ++i) {
    const double* row = k + static_cast<size_t>(i) * size;
    b[i] = (b[i] - Dot(row, b, i)) / row[i];
  }
  for (int i = size - 1; i >= 0; --i) {
    const double* row = k + static_cast<size_t>(i) * size;
    b[i] /= row[i];
    AddScaled(-b[i], row, b, i);
  }
}

}  // namespace

void LevelStep::Reserve(int column_count, int constraint_count, int row_count) {
  if (column_count != column_count_) ForgetHolds();
  column_count_ = column_count;
  constraint_count_ = 0;
  row_count_ = 0;
  const size_t n = column_count;
  const size_t m = constraint_count;
  const size_t k = row_count;
  for (auto* of_columns : {&diagonal_, &pull_, &lower_, &upper_, &scale_, &z_,
                           &gradient_, &step_, &move_}) {
    Grow(*of_columns, n);
  }
  Grow(holds_, n);
  Grow(drops_, n + m);
  for (auto* of_constraints : {&c_, &room_, &speed_, &multipliers_}) {
    Grow(*of_constraints, m);
  }
  Grow(at_least_, m);
  Grow(active_, m);
  for (auto* of_rows : {&e_, &rest_, &misses_}) Grow(*of_rows, k);
  Grow(one_sided_, k);
  Grow(counts_, k);
  Grow(a_, n * m);
  Grow(j_, n * k);
  Grow(turned_, n * k);
  Grow(small_, k * k);
  null_space_.Reserve(column_count, constraint_count);
}

void LevelStep::ForgetHolds() {
  std::fill(holds_.begin(), holds_.end(), Hold::kFree);
}

LevelStep::MatrixView LevelStep::AddConstraints(int count, bool at_least) {
  const int first = constraint_count_;
  constraint_count_ += count;
  std::fill_n(at_least_.begin() + first, count, at_least ? 1 : 0);
  std::fill_n(c_.begin() + first, count, 0.0);
  MatrixView rows(a_.data() + static_cast<size_t>(first) * column_count_, count,
                  column_count_);
  rows.setZero();
  return rows;
}

LevelStep::MatrixView LevelStep::AddRows(int count) {
  const int first = row_count_;
  row_count_ += count;
  std::fill_n(e_.begin() + first, count, 0.0);
  std::fill_n(one_sided_.begin() + first, count, 0);
  std::fill_n(counts_.begin() + first, count, 1);
  MatrixView rows(j_.data() + static_cast<size_t>(first) * column_count_, count,
                  column_count_);
  rows.setZero();
  return rows;
}

bool LevelStep::Solve() {
  StartActiveSet();
  bool settled = SolveByBlocks();
  if (!settled) {
    std::fill_n(holds_.begin(), column_count_, Hold::kFree);
    StartActiveSet();
  }
  for (int round = 0; round < kMaxRounds && !settled; ++round) {
    SolveActiveSet();
    settled = !MoveToFirstBound() && !DropWrong() && !FlipOneSided();
  }
  MeasureForces();
  return settled;
}

bool LevelStep::SolveConstraints() {
  StartActiveSet();
  return SolveByBlocks();
}

void LevelStep::ShortenWish() {
  double most = 0;
  for (int i = 0; i < column_count_; ++i) {
    if (holds_[i] != Hold::kFree) continue;
    most = std::max(most, std::abs(step_[i]) / (upper_[i] - lower_[i]));
  }
  if (most <= kOverreach) return;
  const double part = kOverreach / most;
  for (int r = 0; r < row_count_; ++r) e_[r] *= part;
  for (int i = 0; i < column_count_; ++i) {
    pull_[i] *= part;
    step_[i] *= part;
  }
}

bool LevelStep::SolveByBlocks() {
  for (int round = 0; round < kBlockRounds; ++round) {
    for (int i = 0; i < column_count_; ++i) {
      step_[i] = holds_[i] == Hold::kLower   ? lower_[i]
                 : holds_[i] == Hold::kUpper ? upper_[i]
                                             : 0;
    }
    SolveActiveSet();
    AddScaled(1, move_.data(), step_.data(), column_count_);
    if (round == 0 && shortens_wish_) ShortenWish();
    if (ReleaseForRows()) continue;
    std::fill_n(drops_.begin(), column_count_ + constraint_count_, 0);
    const bool dropped = DropWrong();
    if (!HoldViolated() && !dropped && !FlipOneSided()) return true;
  }
  return false;
}

bool LevelStep::ReleaseForRows() {
  // The way in which columns would have to move.
  std::fill_n(z_.begin(), column_count_, 0.0);
  bool off = false;
  for (int r = 0; r < constraint_count_; ++r) {
    if (active_[r] == 0) continue;
    const double left = c_[r] - Dot(A(r), step_.data(), column_count_);
    if (std::abs(left) <= kHolds) continue;
    off = true;
    AddScaled(left, A(r), z_.data(), column_count_);
  }
  if (!off) return false;
  double most = 0;
  const auto inwards = [&](int i) {
    if (holds_[i] == Hold::kFree || lower_[i] >= upper_[i]) return 0.0;
    return holds_[i] == Hold::kLower ? z_[i] : -z_[i];
  };
  for (int i = 0; i < column_count_; ++i) most = std::max(most, inwards(i));
  for (int i = 0; i < column_count_ && most > 0; ++i) {
    if (inwards(i) >= kHelps * most) holds_[i] = Hold::kFree;
  }
  return true;
}

bool LevelStep::HoldViolated() {
  bool violated = false;
  for (int i = 0; i < column_count_; ++i) {
    if (holds_[i] != Hold::kFree || scale_[i] == 0) continue;
    if (step_[i] < lower_[i] - kFeasible) {
      holds_[i] = Hold::kLower;
    } else if (step_[i] > upper_[i] + kFeasible) {
      holds_[i] = Hold::kUpper;
    } else {
      continue;
    }
    violated = true;
  }
  for (int r = 0; r < constraint_count_; ++r) {
    if (active_[r] != 0 ||
        Dot(A(r), step_.data(), column_count_) >= c_[r] - kFeasible) {
      continue;
    }
    active_[r] = 1;
    violated = true;
  }
  return violated;
}

void LevelStep::StartActiveSet() {
  for (int i = 0; i < column_count_; ++i) {
    const bool held = holds_[i] == Hold::kLower   ? lower_[i] >= 0
                      : holds_[i] == Hold::kUpper ? upper_[i] <= 0
                                                  : false;
    if (!held) holds_[i] = Hold::kFree;
    if (lower_[i] >= upper_[i]) holds_[i] = Hold::kLower;
  }
  for (int r = 0; r < constraint_count_; ++r) {
    active_[r] = at_least_[r] == 0 ? 1 : 0;
  }
  std::fill_n(drops_.begin(), column_count_ + constraint_count_, 0);
  std::fill_n(step_.begin(), column_count_, 0.0);
}

void LevelStep::SolveActiveSet() {
  for (int i = 0; i < column_count_; ++i) {
    scale_[i] = holds_[i] == Hold::kFree ? 1 / std::sqrt(diagonal_[i]) : 0;
  }
  null_space_.Factorize(a_.data(), constraint_count_, active_.data(),
                        scale_.data());
  // From where the step is: what is left of the rows and of the pull, turned.
  for (int r = 0; r < row_count_; ++r) {
    rest_[r] = e_[r] - Dot(J(r), step_.data(), column_count_);
  }
  for (int i = 0; i < column_count_; ++i) {
    z_[i] = scale_[i] * (pull_[i] - diagonal_[i] * step_[i]);
  }
  null_space_.ApplyTransposed(z_.data());
  for (int r = 0; r < constraint_count_; ++r) {
    if (active_[r] != 0) {
      room_[r] = c_[r] - Dot(A(r), step_.data(), column_count_);
    }
  }
  null_space_.SolveForms(room_.data(), z_.data());
  SolveRows();
  null_space_.Apply(z_.data());
  for (int i = 0; i < column_count_; ++i) move_[i] = scale_[i] * z_[i];
}

void LevelStep::SolveRows() {
  const int n = column_count_;
  const int k = row_count_;
  const int rank = null_space_.rank();
  for (int r = 0; r < k; ++r) {
    double* row = turned_.data() + static_cast<size_t>(r) * n;
    double* sums = small_.data() + static_cast<size_t>(r) * k;
    if (counts_[r] == 0) {
      std::fill_n(row, n, 0.0);
      rest_[r] = 0;
    } else {
      for (int i = 0; i < n; ++i) row[i] = J(r)[i] * scale_[i];
      null_space_.ApplyTransposed(row);
      rest_[r] -= Dot(row, z_.data(), n);
    }
    for (int s = 0; s <= r; ++s) {
      sums[s] =
          Dot(row + rank, turned_.data() + static_cast<size_t>(s) * n + rank,
              n - rank);
    }
    sums[r] += 1;
  }
  Cholesky(small_.data(), k);
  SolveCholesky(small_.data(), k, rest_.data());
  for (int r = 0; r < k; ++r) {
    AddScaled(rest_[r], turned_.data() + static_cast<size_t>(r) * n + rank,
              z_.data() + rank, n - rank);
  }
}

bool LevelStep::MoveToFirstBound() {
  // How far the move may go, and who says so.
  double most = 1;
  const auto limit = [&most](double room, double speed) {
    if (speed > 0 && room < most * speed) most = std::max(0.0, room / speed);
  };
  for (int i = 0; i < column_count_; ++i) {
    if (holds_[i] != Hold::kFree) continue;
    limit(upper_[i] - step_[i], move_[i]);
    limit(step_[i] - lower_[i], -move_[i]);
  }
  for (int r = 0; r < constraint_count_; ++r) {
    if (active_[r] != 0) continue;
    room_[r] = Dot(A(r), step_.data(), column_count_) - c_[r];
    speed_[r] = -Dot(A(r), move_.data(), column_count_);
    limit(room_[r], speed_[r]);
  }
  AddScaled(most, move_.data(), step_.data(), column_count_);
  if (most == 1) return false;
  for (int i = 0; i < column_count_; ++i) {
    if (holds_[i] != Hold::kFree || move_[i] == 0) continue;
    if (move_[i] > 0 && step_[i] >= upper_[i] - kFeasible) {
      holds_[i] = Hold::kUpper;
      step_[i] = upper_[i];
    } else if (move_[i] < 0 && step_[i] <= lower_[i] + kFeasible) {
      holds_[i] = Hold::kLower;
      step_[i] = lower_[i];
    }
  }
  for (int r = 0; r < constraint_count_; ++r) {
    if (active_[r] != 0 || speed_[r] <= 0) continue;
    if (room_[r] - most * speed_[r] <= kFeasible) active_[r] = 1;
  }
  return true;
}

void LevelStep::ComputeMultipliers() {
  const int n = column_count_;
  for (int i = 0; i < n; ++i) {
    gradient_[i] = diagonal_[i] * step_[i] - pull_[i];
  }
  for (int r = 0; r < row_count_; ++r) {
    misses_[r] = 0;
    if (counts_[r] == 0) continue;
    misses_[r] = Dot(J(r), step_.data(), n) - e_[r];
    AddScaled(misses_[r], J(r), gradient_.data(), n);
  }
  // Q R P^T mu = -D^-1/2 g.
  for (int i = 0; i < n; ++i) z_[i] = -scale_[i] * gradient_[i];
  null_space_.ApplyTransposed(z_.data());
  null_space_.SolveMultipliers(z_.data(), multipliers_.data());
  for (int r = 0; r < constraint_count_; ++r) {
    if (multipliers_[r] != 0) {
      AddScaled(multipliers_[r], A(r), gradient_.data(), n);
    }
  }
}

bool LevelStep::DropWrong() {
  bool holds_any = false;
  for (int i = 0; i < column_count_; ++i) {
    holds_any =
        holds_any || (holds_[i] != Hold::kFree && lower_[i] < upper_[i]);
  }
  for (int r = 0; r < constraint_count_; ++r) {
    holds_any = holds_any || (at_least_[r] != 0 && active_[r] != 0);
  }
  if (!holds_any) return false;
  ComputeMultipliers();
  double scale = 0;
  for (int i = 0; i < column_count_; ++i) {
    scale = std::max({scale, std::abs(gradient_[i]), std::abs(pull_[i])});
  }
  const double most = kWrongSign * scale;
  bool dropped = false;
  const auto drop = [&](int& drops) {
    dropped = dropped || drops < kMaxDrops;
    return drops++ < kMaxDrops;
  };
  for (int i = 0; i < column_count_; ++i) {
    if (holds_[i] == Hold::kFree || lower_[i] >= upper_[i]) continue;
    const double inwards =
        holds_[i] == Hold::kLower ? -gradient_[i] : gradient_[i];
    if (inwards > most && drop(drops_[i])) holds_[i] = Hold::kFree;
  }
  for (int r = 0; r < constraint_count_; ++r) {
    if (at_least_[r] == 0 || active_[r] == 0 || multipliers_[r] <= 0) continue;
    if (drop(drops_[column_count_ + r])) active_[r] = 0;
  }
  return dropped;
}

bool LevelStep::FlipOneSided() {
  bool flipped = false;
  for (int r = 0; r < row_count_; ++r) {
    if (one_sided_[r] == 0) continue;
    const double beyond = Dot(J(r), step_.data(), column_count_) - e_[r];
    // One that pulls back is let go where others outweigh it; damping does not.
    const double slack = kWrongSide + kOutweighed * std::max(0.0, -e_[r]);
    const bool counts =
        counts_[r] != 0 ? beyond <= slack : beyond < -kWrongSide;
    if (counts == (counts_[r] != 0)) continue;
    counts_[r] = counts ? 1 : 0;
    flipped = true;
  }
  return flipped;
}

void LevelStep::MeasureForces() {
  ComputeMultipliers();
  bound_force_ = 0;
  free_force_ = 0;
  gain_ = 0;
  // What the step does away with: D x + J^T J x.
  for (int i = 0; i < column_count_; ++i) {
    z_[i] = diagonal_[i] * step_[i];
    gain_ += step_[i] * (pull_[i] - 0.5 * z_[i]);
  }
  for (int r = 0; r < row_count_; ++r) {
    if (counts_[r] == 0) continue;
    gain_ += 0.5 * (e_[r] * e_[r] - misses_[r] * misses_[r]);
    AddScaled(misses_[r] + e_[r], J(r), z_.data(), column_count_);
  }
  for (int i = 0; i < column_count_; ++i) {
    if (holds_[i] == Hold::kFree) {
      free_force_ = std::max(free_force_, std::abs(z_[i]));
    } else if (step_[i] == 0) {
      bound_force_ = std::max(bound_force_, std::abs(gradient_[i]));
    }
  }
}

void LevelStep::Correct(const double* values, double* x) {
  std::fill_n(z_.begin(), column_count_, 0.0);
  null_space_.SolveForms(values, z_.data());
  null_space_.Apply(z_.data());
  for (int i = 0; i < column_count_; ++i) x[i] = scale_[i] * z_[i];
}

}  // namespace gelenk
