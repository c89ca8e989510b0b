#include "gelenk/ik/goal_levels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "gelenk/ik/goals/frame_rows.h"
#include "gelenk/ik/kernel_exchange.h"
#include "gelenk/ik/posture_terms.h"
#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

using kernel::GoalShape;
using kernel::PostureTerm;

double Scale(const kernel::TaskTarget& target, int row) {
  return target.row_scale[row < target.translation_rows ? row : 3];
}

// From where a rotation is to its posture, body axes, 2 sin(angle / 2) long.
Eigen::Vector3d BodyTurn(const PostureTerm& term,
                         const ConstVectorView& positions) {
  const Eigen::Quaterniond turn =
      QuaternionXyzw(positions.data() + term.position).conjugate() *
      QuaternionXyzw(term.target);
  return (turn.w() < 0 ? -2 : 2) * turn.vec();
}

}  // namespace

void GoalLevels::SetProblem(const IkProblem& problem,
                            const ConstVectorView& start) {
  problem_ = &problem;
  const Skeleton& skeleton = problem.skeleton();
  linearizer_.SetProblem(problem);
  problem.CopyTargets(start, targets_);
  std::array<int, kMaxPriorities> level_of;
  level_of.fill(-1);
  for (const Goal& goal : problem.goals()) {
    if (goal.weight > 0) level_of[goal.priority] = 0;
  }
  level_count_ = 0;
  postures_.resize(kMaxPriorities);
  row_counts_.assign(kMaxPriorities, 0);
  first_columns_.resize(skeleton.joint_count());
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    first_columns_[j] = skeleton.span(j).velocity_offset;
  }
  for (int priority = 0; priority < kMaxPriorities; ++priority) {
    if (level_of[priority] < 0) continue;
    level_of[priority] = level_count_;
    JoinPostures(skeleton, problem.goals(), priority, first_columns_,
                 postures_[level_count_]);
    ++level_count_;
  }
  moves_.assign(skeleton.joint_count(), 0);
  states_.resize(problem.goals().size());
  const size_t scratch =
      size_t{kernel::kMaxGoalRows} * skeleton.velocity_count();
  if (scratch_.size() < scratch) scratch_.resize(scratch);
  for (size_t g = 0; g < states_.size(); ++g) {
    const Goal& goal = problem.goals()[g];
    const int index = static_cast<int>(g);
    State& state = states_[g];
    state.level = goal.weight > 0 ? level_of[goal.priority] : -1;
    state.bound = false;
    state.rows.position_error2 = 0;
    state.rows.rotation_error2 = 0;
    if (state.level < 0) continue;
    for (int r = 0; r < GoalLinearizer::RowCount(targets_[g]); ++r) {
      if (Counts(index, r)) ++row_counts_[state.level];
    }
    MarkMoving(index);
  }
  held_levels_ = 0;
  held_row_count_ = 0;
}

bool GoalLevels::Counts(int goal, int row) const {
  return Scale(targets_[goal], row) > 0;
}

void GoalLevels::MarkMoving(int goal) {
  const Skeleton& skeleton = problem_->skeleton();
  if (targets_[goal].shape == GoalShape::kCenterOfMass) {
    std::fill(moves_.begin(), moves_.end(), 1);
    return;
  }
  const EffectorTask& task = linearizer_.task(goal);
  for (int f = 0; f < task.frame_count; ++f) {
    for (int j = task.frames[f].joint; j >= 0; j = skeleton.span(j).parent) {
      moves_[j] = 1;
      if (skeleton.span(j).mimicked >= 0) moves_[skeleton.span(j).mimicked] = 1;
    }
  }
}

void GoalLevels::BeginLevel(int level) {
  held_levels_ = level;
  held_row_count_ = 0;
  for (int l = 0; l < level; ++l) held_row_count_ += row_counts_[l];
  for (State& state : states_) {
    if (state.level >= level) state.bound = false;
  }
}

void GoalLevels::MoveTo(const ConstVectorView& positions, int last) {
  linearizer_.MoveTo(positions);
  for (size_t g = 0; g < states_.size(); ++g) {
    State& state = states_[g];
    if (state.level < 0 || state.level > last) continue;
    linearizer_.Evaluate(static_cast<int>(g), targets_[g], state.rows);
  }
}

double GoalLevels::HalfSpaceDepth(const State& state) const {
  const double depth = -state.rows.clearance;
  return state.bound ? depth : std::max(0.0, depth);
}

double GoalLevels::GoalEnergy(int level) const {
  double energy = 0;
  for (size_t g = 0; g < states_.size(); ++g) {
    const State& state = states_[g];
    const kernel::TaskTarget& target = targets_[g];
    if (state.level != level) continue;
    if (target.shape == GoalShape::kHalfSpace) {
      const double e = target.row_scale[0] * HalfSpaceDepth(state);
      energy += 0.5 * e * e;
      continue;
    }
    energy +=
        target.row_scale[3] * target.row_scale[3] * state.rows.rotation_energy;
    for (int r = 0; r < target.translation_rows; ++r) {
      const double e = target.row_scale[r] * state.rows.residual[r];
      energy += 0.5 * e * e;
    }
  }
  return energy;
}

double GoalLevels::PostureEnergy(int level,
                                 const ConstVectorView& positions) const {
  double energy = 0;
  for (const PostureTerm& term : postures_[level]) {
    if (term.rotation) {
      energy +=
          term.weight * AngleEnergy(BodyTurn(term, positions).squaredNorm());
      continue;
    }
    const double way = term.target[0] - positions[term.position];
    energy += 0.5 * term.weight * way * way;
  }
  return energy;
}

bool GoalLevels::IsWithin(int level, double position_tolerance,
                          double rotation_tolerance) const {
  const double chord = 2 * std::sin(0.5 * std::min(rotation_tolerance, M_PI));
  for (size_t g = 0; g < states_.size(); ++g) {
    const State& state = states_[g];
    if (state.level != level) continue;
    // So written that NaN is not within.
    if (!(state.rows.position_error2 <=
              position_tolerance * position_tolerance &&
          state.rows.rotation_error2 <= chord * chord)) {
      return false;
    }
    if (state.bound && state.rows.clearance > position_tolerance) return false;
  }
  return true;
}

double GoalLevels::position_error(int goal) const {
  return std::sqrt(states_[goal].rows.position_error2);
}

double GoalLevels::rotation_error(int goal) const {
  return AngleOf(states_[goal].rows.rotation_error2);
}

void GoalLevels::Hold(int level) {
  for (size_t g = 0; g < states_.size(); ++g) {
    State& state = states_[g];
    if (state.level != level) continue;
    std::copy_n(state.rows.residual, kernel::kMaxGoalRows, state.held);
    state.held[0] = targets_[g].shape == GoalShape::kHalfSpace
                        ? std::min(0.0, state.rows.clearance)
                        : state.held[0];
  }
  held_levels_ = level + 1;
  held_row_count_ += row_counts_[level];
}

double GoalLevels::Deviation(double* values) const {
  double largest = 0;
  for (size_t g = 0; g < states_.size(); ++g) {
    const State& state = states_[g];
    const kernel::TaskTarget& target = targets_[g];
    if (state.level < 0 || state.level >= held_levels_) continue;
    for (int r = 0; r < GoalLinearizer::RowCount(target); ++r) {
      if (!Counts(static_cast<int>(g), r)) continue;
      double value = state.rows.residual[r] - state.held[r];
      if (target.shape == GoalShape::kHalfSpace) {
        value = std::max(0.0, state.held[0] - state.rows.clearance);
      }
      largest = std::max(largest, std::abs(value));
      if (values != nullptr) *values++ = value;
    }
  }
  return largest;
}

int GoalLevels::row_count(int level) const {
  return row_counts_[level] + 3 * static_cast<int>(postures_[level].size());
}

LevelStep::MatrixView GoalLevels::ComputeJacobian(
    int goal, const ConstVectorView& positions) {
  State& state = states_[goal];
  const kernel::TaskTarget& target = targets_[goal];
  if (target.shape == GoalShape::kHalfSpace) {
    // On the free side, too.
    VelocityRow(state.rows, 0, 0) = View(target.direction);
  }
  const LevelStep::MatrixView jacobian(scratch_.data(),
                                       GoalLinearizer::RowCount(target),
                                       problem_->skeleton().velocity_count());
  linearizer_.ComputeJacobian(goal, target, state.rows, positions, jacobian);
  return jacobian;
}

void GoalLevels::AddHeld(const ConstVectorView& positions, bool restore,
                         LevelStep& step) {
  for (size_t g = 0; g < states_.size(); ++g) {
    const State& state = states_[g];
    const kernel::TaskTarget& target = targets_[g];
    const int goal = static_cast<int>(g);
    if (state.level < 0 || state.level >= held_levels_) continue;
    const LevelStep::MatrixView jacobian = ComputeJacobian(goal, positions);
    const bool one_sided = target.shape == GoalShape::kHalfSpace;
    for (int r = 0; r < GoalLinearizer::RowCount(target); ++r) {
      if (!Counts(goal, r)) continue;
      LevelStep::MatrixView row = step.AddConstraints(1, one_sided);
      row = jacobian.row(r);
      const double back = one_sided ? state.held[0] - state.rows.clearance
                                    : state.rows.residual[r] - state.held[r];
      step.SetConstraint(step.constraint_count() - 1, restore ? back
                                                      : one_sided
                                                          ? std::min(0.0, back)
                                                          : 0);
    }
  }
}

void GoalLevels::AddLevel(int level, const ConstVectorView& positions,
                          const StepSpace& space, LevelStep& step) {
  for (size_t g = 0; g < states_.size(); ++g) {
    const State& state = states_[g];
    const kernel::TaskTarget& target = targets_[g];
    const int goal = static_cast<int>(g);
    if (state.level != level) continue;
    const LevelStep::MatrixView jacobian = ComputeJacobian(goal, positions);
    for (int r = 0; r < GoalLinearizer::RowCount(target); ++r) {
      if (!Counts(goal, r)) continue;
      const double scale = Scale(target, r);
      LevelStep::MatrixView row = step.AddRows(1);
      row = scale * jacobian.row(r);
      const int index = step.row_count() - 1;
      step.SetRow(index, scale * state.rows.residual[r]);
      if (target.shape != GoalShape::kHalfSpace) continue;
      step.SetRow(index, -scale * state.rows.clearance);
      step.SetOneSided(index, state.bound || state.rows.clearance < 0);
    }
  }
  for (const PostureTerm& term : postures_[level]) {
    const StepSpace::Basis* basis =
        term.rotation ? space.BasisAt(term.column) : nullptr;
    if (basis == nullptr || basis->orthogonal) continue;
    // Not orthogonal: no diagonal holds it.
    const double root = std::sqrt(term.weight);
    LevelStep::MatrixView rows = step.AddRows(3);
    rows.block<3, 3>(0, term.column) =
        root * Eigen::Matrix3d::Identity();  // turned with all others
    const Eigen::Vector3d turn = root * BodyTurn(term, positions);
    for (int k = 0; k < 3; ++k) step.SetRow(step.row_count() - 3 + k, turn[k]);
  }
}

void GoalLevels::SetDiagonal(int level, absl::Span<const double> damping,
                             const ConstVectorView& positions,
                             const StepSpace& space, LevelStep& step) const {
  for (size_t c = 0; c < damping.size(); ++c) {
    step.SetColumn(static_cast<int>(c), damping[c], 0);
  }
  for (const PostureTerm& term : postures_[level]) {
    const int c = term.column;
    if (!term.rotation) {
      step.SetColumn(c, damping[c] + term.weight,
                     term.weight * (term.target[0] - positions[term.position]));
      continue;
    }
    const StepSpace::Basis* basis = space.BasisAt(c);
    if (basis != nullptr && !basis->orthogonal) continue;
    Eigen::Vector3d turn = BodyTurn(term, positions);
    if (basis != nullptr) turn = basis->axes.transpose() * turn;
    for (int k = 0; k < 3; ++k) {
      step.SetColumn(c + k, damping[c + k] + term.weight,
                     term.weight * turn[k]);
    }
  }
}

bool GoalLevels::BindHalfSpaces(int level, const LevelStep& step) {
  bool changed = false;
  int row = 0;
  for (size_t g = 0; g < states_.size(); ++g) {
    State& state = states_[g];
    if (state.level != level) continue;
    if (targets_[g].shape == GoalShape::kHalfSpace) {
      const bool bound = Counts(static_cast<int>(g), 0) && step.Counts(row);
      changed = changed || bound != state.bound;
      state.bound = bound;
    }
    for (int r = 0; r < GoalLinearizer::RowCount(targets_[g]); ++r) {
      if (Counts(static_cast<int>(g), r)) ++row;
    }
  }
  return changed;
}

}  // namespace gelenk
