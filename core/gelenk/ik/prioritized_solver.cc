#include "gelenk/ik/prioritized_solver.h"

#include <algorithm>

#include "gelenk/ik/kernel_exchange.h"
#include "gelenk/ik/on_limit.h"
#include "gelenk/ik/solve_diagnosis.h"
#include "gelenk/ik/start_sampler.h"

namespace gelenk {
namespace {

using kernel::AttemptEnd;

// Iterations of the last attempt against those of the others.
constexpr int kPolishFactor = 4;
// Levels that others are solved within are not left at their tolerance: what
// they miss by would count as theirs for good. m, rad.
constexpr double kHoldingTolerance = 1e-7;
// Energies nearer than this are the same: a part of them, and at least this.
constexpr double kSameEnergy = 1e-6;
constexpr double kNoEnergy = 1e-12;

using ConstVectorMap = Eigen::Map<const Eigen::VectorXd>;

ConstVectorMap View(const std::vector<double>& numbers) {
  return ConstVectorMap(numbers.data(), numbers.size());
}

// -1 where a is less.
int Compare(double a, double b) {
  const double tolerance = kNoEnergy + kSameEnergy * std::max(a, b);
  return a < b - tolerance ? -1 : a > b + tolerance ? 1 : 0;
}

// False for an attempt that was given up.
bool IsBetter(const std::vector<double>& energies,
              const std::vector<double>& best) {
  if (energies.size() < best.size()) return false;
  for (size_t level = 0; level < best.size(); ++level) {
    const int order = Compare(energies[level], best[level]);
    if (order != 0) return order < 0;
  }
  return false;
}

}  // namespace

void PrioritizedSolver::Solve(const IkProblem& problem,
                              const SolverOptions& options, SolveStart start,
                              VectorView positions, SolveReport& report,
                              const StopCondition& stop,
                              const StepBounds* bounds) {
  const Skeleton& skeleton = problem.skeleton();
  const bool bounded = start == SolveStart::kWarm &&
                       (options.max_step.has_value() || bounds != nullptr);
  start_.assign(positions.begin(), positions.end());
  goals_.SetProblem(problem, positions);
  ClampToLimits(skeleton, positions);
  if (bounded) {
    space_.Reset(skeleton, options.max_step, bounds, positions);
  } else {
    space_.Reset(skeleton, std::nullopt, nullptr, positions);
  }
  descent_.SetProblem(problem, goals_, space_);
  // Starts from elsewhere would be out of bounds.
  const int budget = bounded ? 0 : RestartBudget(options, start);
  const LevelSettings settings = {options.position_tolerance_m,
                                  options.rotation_tolerance_rad,
                                  options.max_iterations,
                                  bounded,
                                  budget > 0,
                                  stop};
  report.iteration_count = 0;
  report.restart_count = 0;
  Run(options, settings, nullptr, positions, levels_, report);
  if (levels_.end != AttemptEnd::kConverged &&
      levels_.end != AttemptEnd::kStopped && budget > 0) {
    Restart(problem, options, budget, settings, positions, report);
  }
  AlignHemispheres(skeleton, View(start_), positions);
  report.outcome = OutcomeOf(levels_.end, levels_.pushed_at_limit);
  Report(problem, options, positions, report);
}

void PrioritizedSolver::Run(const SolverOptions& options,
                            LevelSettings settings, const Levels* best,
                            VectorView positions, Levels& levels,
                            SolveReport& report) {
  levels.end = AttemptEnd::kConverged;
  levels.pushed_at_limit = false;
  levels.energies.clear();
  bool ties = true;
  for (int level = 0; level < goals_.level_count(); ++level) {
    const bool last = level + 1 == goals_.level_count();
    settings.position_tolerance_m = options.position_tolerance_m;
    settings.rotation_tolerance_rad = options.rotation_tolerance_rad;
    if (!last) {
      settings.position_tolerance_m =
          std::min(settings.position_tolerance_m, kHoldingTolerance);
      settings.rotation_tolerance_rad =
          std::min(settings.rotation_tolerance_rad, kHoldingTolerance);
    }
    const kernel::Attempt attempt =
        descent_.Run(goals_, level, settings, space_, positions);
    report.iteration_count += attempt.iterations;
    levels.energies.push_back(attempt.energy);
    const bool met = goals_.IsWithin(level, options.position_tolerance_m,
                                     options.rotation_tolerance_rad);
    if (!met && levels.end == AttemptEnd::kConverged) {
      // Well within is not always where it ends.
      levels.end = attempt.end;
      levels.pushed_at_limit = attempt.pushed_at_limit;
    }
    if (attempt.end == AttemptEnd::kStopped) {
      levels.end = AttemptEnd::kStopped;
      return;
    }
    goals_.Hold(level);
    if (best == nullptr || !ties || last) continue;
    const int order = Compare(attempt.energy, best->energies[level]);
    if (order > 0) {
      levels.end = AttemptEnd::kImpatient;
      return;
    }
    ties = order == 0;
  }
}

void PrioritizedSolver::Restart(const IkProblem& problem,
                                const SolverOptions& options, int budget,
                                LevelSettings settings, VectorView positions,
                                SolveReport& report) {
  moving_joints_.clear();
  for (int j = 0; j < problem.skeleton().joint_count(); ++j) {
    if (goals_.moves()[j] != 0 && problem.skeleton().span(j).mimicked < 0) {
      moving_joints_.push_back(j);
    }
  }
  StartSampler sampler(options.restart_seed);
  best_.assign(positions.begin(), positions.end());
  best_levels_ = levels_;
  while (levels_.end != AttemptEnd::kConverged &&
         levels_.end != AttemptEnd::kStopped && report.restart_count < budget) {
    ++report.restart_count;
    sampler.Sample(problem.skeleton(), moving_joints_, View(start_), positions);
    Run(options, settings, &best_levels_, positions, levels_, report);
    if (IsBetter(levels_.energies, best_levels_.energies)) {
      best_levels_ = levels_;
      best_.assign(positions.begin(), positions.end());
    }
  }
  if (levels_.end == AttemptEnd::kConverged) return;
  // Nothing reached: finish the best attempt with patience.
  positions = View(best_);
  settings.impatient = false;
  settings.max_iterations *= kPolishFactor;
  Run(options, settings, nullptr, positions, levels_, report);
}

void PrioritizedSolver::Report(const IkProblem& problem,
                               const SolverOptions& options,
                               const ConstVectorView& positions,
                               SolveReport& report) {
  const Skeleton& skeleton = problem.skeleton();
  const int goal_count = static_cast<int>(problem.goals().size());
  goals_.MoveTo(positions, goals_.level_count() - 1);
  report.position_errors_m.resize(goal_count);
  report.rotation_errors_rad.resize(goal_count);
  for (int g = 0; g < goal_count; ++g) {
    report.position_errors_m[g] = goals_.position_error(g);
    report.rotation_errors_rad[g] = goals_.rotation_error(g);
  }
  report.limited_joints.clear();
  report.limited_joints.reserve(skeleton.joint_count());
  report.change = 0;
  if (options.detail == ReportDetail::kBrief) return;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (goals_.moves()[j] != 0 && IsOnLimit(skeleton, j, positions)) {
      report.limited_joints.push_back(j);
    }
  }
  change_.resize(skeleton.velocity_count());
  report.change = WeightedChange(
      problem, View(start_), positions,
      Eigen::Map<Eigen::VectorXd>(change_.data(), change_.size()));
  if (options.detail == ReportDetail::kDiagnosis) {
    Diagnose(problem, positions, report);
  }
}

}  // namespace gelenk
