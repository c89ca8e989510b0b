// When an attempt goes on, turns round and ends: the policy that the kernels of
// trees and of chains share.
//
// For the kernels only, like base/kernel/lanes.h.
#ifndef GELENK_IK_KERNEL_DESCENT_H_
#define GELENK_IK_KERNEL_DESCENT_H_

#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel {
namespace {

// The damping never vanishes: something must hold joints that move nothing.
constexpr double kDampingFloor = 1e-9;
// After a step that raised the energy the damping grows by this factor, and
// shrinks back after one that lowered it.
constexpr double kDampingGrowth = 8;
constexpr double kDampingShrink = 0.25;
constexpr double kMaxDampingFactor = 1e8;
// Steps that raised the energy in a row before the best pose is taken up again.
constexpr int kUphillSteps = 2;
// Progress is looked at every so many iterations.
constexpr int kWindow = 6;
// An impatient attempt wants the energy halved in each window; a patient one
// ends where a window gains less than this part.
constexpr double kImpatientGain = 0.5;
constexpr double kStationaryGain = 1e-5;
// No single step turns a joint by more than this, rad (or m): the linear model
// is void beyond.
constexpr double kMaxStep = 1.5;
// With a posture, which has no tolerance: it has settled after an undamped step
// of no more than this, rad or m, for the next one is about its square; and
// where so small steps gain less than kStationaryGain twice in a row, goals and
// posture have found their balance.
constexpr double kSettledMove = 5e-3;
constexpr int kIdleSteps = 2;

// Takes damped steps until the goals are met or there is no more to gain; then
// leaves the model at the best pose.
//
// The damping is proportional to the energy (Sugihara 2011): strong far away,
// gone at the target, so that the last steps converge quadratically.
//
// A posture only pulls: it is part of the energy that steps must lower, but how
// far the goals are, and whether they still come nearer, is read off the rest.
// The goals being met, the attempt ends when the posture has settled, too.
//
// Model has
//   double Evaluate()            half the weighted squared error where it is
//   double PostureEnergy()       the part of it that is a posture's
//   bool IsWithinTolerance()     there
//   void KeepBest(), TakeBest()  remember where it is, go back there
//   bool Linearize()             what is free to move, and how; whether a
//                                coordinate at a bound is pushed outwards
//   void Step(double damping)    from there
//   double LastMove()            the largest change of that step, rad or m
template <typename Model>
GELENK_INLINE Attempt Descend(Model& model, const Settings& settings,
                              double damping_per_energy) {
  Attempt attempt = {AttemptEnd::kIterations, 0, 0, false};
  double factor = 1;
  double best = -1;
  double best_goals = -1;
  double window_energy = -1;
  double window_goals = -1;
  int uphill = 0;
  int idle = 0;
  const bool has_posture = settings.posture_count > 0;
  for (int iteration = 0;; ++iteration) {
    const double energy = model.Evaluate();
    const double goal_energy = energy - model.PostureEnergy();
    attempt.iterations = iteration;
    attempt.energy = energy;
    const bool small_step =
        has_posture && iteration > 0 && model.LastMove() <= kSettledMove;
    const bool settled = !has_posture || (small_step && factor <= 1);
    if (settled && model.IsWithinTolerance()) {
      attempt.end = AttemptEnd::kConverged;
      return attempt;
    }
    idle = small_step && energy > (1 - kStationaryGain) * best ? idle + 1 : 0;
    if (best < 0 || energy < best) {
      best = energy;
      best_goals = goal_energy;
      model.KeepBest();
      factor *= kDampingShrink;
      if (factor < 1) factor = 1;
      uphill = 0;
    } else if (iteration > 0) {
      factor *= kDampingGrowth;
      if (factor > kMaxDampingFactor) factor = kMaxDampingFactor;
      if (++uphill >= kUphillSteps) {
        uphill = 0;
        model.TakeBest();
        model.Evaluate();
      }
    }
    if (idle >= kIdleSteps) {
      attempt.end = AttemptEnd::kStationary;
      break;
    }
    if (iteration >= settings.max_iterations) break;
    if (settings.stop != nullptr && settings.stop(settings.stop_context)) {
      attempt.end = AttemptEnd::kStopped;
      break;
    }
    if (iteration % kWindow == 0) {
      if (iteration > 0) {
        if (settings.impatient && best_goals > kImpatientGain * window_goals) {
          attempt.end = AttemptEnd::kImpatient;
          break;
        }
        if (best > (1 - kStationaryGain) * window_energy &&
            best_goals > (1 - kStationaryGain) * window_goals) {
          attempt.end = AttemptEnd::kStationary;
          break;
        }
      }
      window_energy = best;
      window_goals = best_goals;
    }
    model.Linearize();
    // Relative to the energy at the pose that is left, not the best one.
    model.Step(factor * (damping_per_energy * goal_energy + kDampingFloor));
  }
  model.TakeBest();
  attempt.energy = model.Evaluate();
  if (has_posture && attempt.end != AttemptEnd::kIterations &&
      model.IsWithinTolerance()) {
    attempt.end = AttemptEnd::kConverged;
    return attempt;
  }
  attempt.pushed_at_limit = model.Linearize();
  return attempt;
}

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_DESCENT_H_
