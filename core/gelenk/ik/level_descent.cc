#include "gelenk/ik/level_descent.h"

#include <algorithm>
#include <cmath>

namespace gelenk {
namespace {

using kernel::AttemptEnd;

// As LevenbergMarquardtSolver has them; see kernel/descent.h.
constexpr double kDampingPerEnergy = 1e-2;
constexpr double kDampingFloor = 1e-9;
constexpr double kDampingGrowth = 8;
constexpr double kDampingShrink = 0.25;
constexpr double kMaxDampingFactor = 1e8;
constexpr int kWindow = 6;
constexpr double kImpatientGain = 0.5;
constexpr double kStationaryGain = 1e-5;
constexpr double kMaxStep = 1.5;
constexpr double kLeastStiffness = 1e-6;

// In place of kStationaryGain where the next frame goes on.
constexpr double kBoundedGain = 1e-2;
// Of the heaviest posture of a level: what holds the joints that have none, and
// keeps the metric well conditioned. Slows a posture by as much.
constexpr double kPostureDamping = 1e-2;
// With a posture: the next step is a small part of one that was so short.
constexpr double kSettledMove = 2e-4;
// A step so short leads nowhere.
constexpr double kNoMove = 1e-10;
// Corrections with the Jacobian of the step, and with one of their own.
constexpr int kQuickRounds = 5;
constexpr int kThoroughRounds = 4;
// A quick one that gains less than this has done what it can.
constexpr double kQuickGain = 0.3;

double LargestOf(LevelStep::ConstVectorMap step) {
  return step.size() == 0 ? 0 : step.cwiseAbs().maxCoeff();
}

}  // namespace

void LevelDescent::SetProblem(const IkProblem& problem, const GoalLevels& goals,
                              const StepSpace& space) {
  const Skeleton& skeleton = problem.skeleton();
  stiffness_.assign(skeleton.velocity_count(), 1);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int v = skeleton.span(j).velocity_offset;
    const std::vector<double>& given = skeleton.joint(j).stiffness;
    if (v < 0 || given.empty()) continue;
    for (int k = 0; k < VelocityCount(skeleton.joint(j).type); ++k) {
      stiffness_[v + k] = std::max(given[k], kLeastStiffness);
    }
  }
  int held = 0;
  int rows = 0;
  for (int level = 0; level < goals.level_count(); ++level) {
    held += goals.row_count(level);
    rows = std::max(rows, goals.row_count(level));
  }
  step_.Reserve(space.size(), held, rows);
  restoring_step_.Reserve(space.size(), held, 0);
  restoring_space_ = space;
  trial_.resize(skeleton.position_count());
  damping_.resize(space.size());
  correction_.resize(space.size());
  deviations_.resize(held);
}

kernel::Attempt LevelDescent::Run(GoalLevels& goals, int level,
                                  const LevelSettings& settings,
                                  StepSpace& space, VectorView positions) {
  goals.BeginLevel(level);
  goals.MoveTo(positions, level);
  const bool has_posture = !goals.posture(level).empty();
  kernel::Attempt attempt = {AttemptEnd::kIterations, 0, 0, false};
  double factor = 1;
  double goal_energy = goals.GoalEnergy(level);
  double energy = goal_energy + goals.PostureEnergy(level, positions);
  double window_energy = energy;
  double window_goals = goal_energy;
  double last_move = -1;
  const double stationary_gain =
      settings.bounded ? kBoundedGain : kStationaryGain;
  step_.SetShortensWish(settings.bounded);
  step_.ForgetHolds();
  bool moved = true;
  bool at_positions = true;
  for (int iteration = 0;; ++iteration) {
    attempt.iterations = iteration;
    const bool settled =
        !has_posture || (last_move >= 0 && last_move <= kSettledMove);
    if (settled && at_positions &&
        goals.IsWithin(level, settings.position_tolerance_m,
                       settings.rotation_tolerance_rad)) {
      attempt.end = AttemptEnd::kConverged;
      break;
    }
    if (iteration >= settings.max_iterations) break;
    if (settings.stop()) {
      attempt.end = AttemptEnd::kStopped;
      break;
    }
    if (iteration > 0 && iteration % kWindow == 0) {
      if (settings.impatient && goal_energy > kImpatientGain * window_goals) {
        attempt.end = AttemptEnd::kImpatient;
        break;
      }
      if (energy >= (1 - stationary_gain) * window_energy &&
          goal_energy >= (1 - stationary_gain) * window_goals) {
        attempt.end = AttemptEnd::kStationary;
        break;
      }
      window_energy = energy;
      window_goals = goal_energy;
    }
    if (moved) Linearize(goals, level, space, positions);
    Damp(goals, level, factor, goal_energy, space, positions);
    step_.Solve();
    if (moved && goals.BindHalfSpaces(level, step_)) {
      goal_energy = goals.GoalEnergy(level);
      energy = goal_energy + goals.PostureEnergy(level, positions);
    }
    const double largest = LargestOf(step_.step());
    attempt.pushed_at_limit = step_.bound_force() > 0 &&
                              step_.bound_force() > 10 * step_.free_force();
    if (largest <= kNoMove) {
      attempt.end = AttemptEnd::kStationary;
      break;
    }
    trial_.assign(positions.begin(), positions.end());
    Eigen::Map<Eigen::VectorXd> trial(trial_.data(), positions.size());
    space.Move(step_.step().data(), std::min(1.0, kMaxStep / largest), trial);
    goals.MoveTo(trial, level);
    at_positions = false;
    moved = false;
    double trial_goals = 0;
    double trial_energy = 0;
    if (Restore(goals, level, space, trial)) {
      trial_goals = goals.GoalEnergy(level);
      trial_energy = trial_goals + goals.PostureEnergy(level, trial);
      moved = trial_energy < energy;
    }
    if (!moved) {
      factor = std::min(factor * kDampingGrowth, kMaxDampingFactor);
      continue;
    }
    positions = trial;
    at_positions = true;
    energy = trial_energy;
    goal_energy = trial_goals;
    last_move = largest;
    factor = std::max(factor * kDampingShrink, 1.0);
  }
  if (!at_positions) goals.MoveTo(positions, level);
  attempt.energy = goal_energy;
  return attempt;
}

void LevelDescent::Linearize(GoalLevels& goals, int level, StepSpace& space,
                             const ConstVectorView& positions) {
  space.MoveTo(positions);
  step_.Reserve(space.size(), goals.held_row_count(), goals.row_count(level));
  goals.AddHeld(positions, false, step_);
  goals.AddLevel(level, positions, space, step_);
  space.TurnColumns(step_.constraints());
  space.TurnColumns(step_.rows());
  for (int c = 0; c < space.size(); ++c) {
    step_.SetBounds(c, space.lower(c), space.upper(c));
  }
}

void LevelDescent::Damp(const GoalLevels& goals, int level, double factor,
                        double goal_energy, const StepSpace& space,
                        const ConstVectorView& positions) {
  double floor = kDampingFloor;
  for (const kernel::PostureTerm& term : goals.posture(level)) {
    floor = std::max(floor, kPostureDamping * term.weight);
  }
  const double damping = factor * (kDampingPerEnergy * goal_energy + floor);
  damping_.resize(stiffness_.size());
  for (size_t c = 0; c < stiffness_.size(); ++c) {
    damping_[c] = damping * stiffness_[c];
  }
  goals.SetDiagonal(level, damping_, positions, space, step_);
}

bool LevelDescent::Restore(GoalLevels& goals, int level, const StepSpace& space,
                           VectorView positions) {
  deviations_.assign(step_.constraint_count(), 0);
  correction_.resize(stiffness_.size());
  double last = 0;
  for (int round = 0;; ++round) {
    const double deviation = goals.Deviation(deviations_.data());
    if (deviation <= kHeldTolerance) return true;
    if (round >= kQuickRounds || (round > 0 && deviation > kQuickGain * last)) {
      break;
    }
    last = deviation;
    step_.Correct(deviations_.data(), correction_.data());
    space.Move(correction_.data(), 1, positions);
    goals.MoveTo(positions, level);
  }
  return RestoreAnew(goals, level, space, positions);
}

bool LevelDescent::RestoreAnew(GoalLevels& goals, int level,
                               const StepSpace& space, VectorView positions) {
  restoring_space_ = space;
  restoring_step_.ForgetHolds();
  double last = 0;
  for (int round = 0; round < kThoroughRounds; ++round) {
    const double deviation = goals.Deviation(nullptr);
    if (deviation <= kHeldTolerance) return true;
    if (round > 0 && deviation > kQuickGain * last) return false;
    last = deviation;
    restoring_space_.MoveTo(positions);
    restoring_step_.Reserve(space.size(), goals.held_row_count(), 0);
    goals.AddHeld(positions, true, restoring_step_);
    restoring_space_.TurnColumns(restoring_step_.constraints());
    for (int c = 0; c < space.size(); ++c) {
      restoring_step_.SetColumn(c, stiffness_[c], 0);
      restoring_step_.SetBounds(c, restoring_space_.lower(c),
                                restoring_space_.upper(c));
    }
    if (!restoring_step_.SolveConstraints()) return false;
    restoring_space_.Move(restoring_step_.step().data(), 1, positions);
    goals.MoveTo(positions, level);
  }
  return goals.Deviation(nullptr) <= kHeldTolerance;
}

}  // namespace gelenk
