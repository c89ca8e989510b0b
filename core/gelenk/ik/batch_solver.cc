#include "gelenk/ik/batch_solver.h"

#include <algorithm>
#include <cmath>

#include "gelenk/ik/kernel_exchange.h"
#include "gelenk/ik/serial_arm.h"
#include "gelenk/ik/solve_arm.h"

namespace gelenk {
namespace {

// Arms at once: enough that lanes which wait for the last ones do not count,
// little enough to stay in the second level of the cache.
constexpr int kBlock = 1024;

// Restarts that a lane tries before the target is left to a search of its own,
// where all lanes look for the same one: most cold targets take fewer.
constexpr int kLaneRestarts = 8;

void ResizeReport(size_t columns, size_t goals, BatchReport& report) {
  report.outcomes.resize(columns);
  report.iteration_counts.resize(columns);
  report.restart_counts.resize(columns);
  report.position_errors_m.resize(columns * goals);
  report.rotation_errors_rad.resize(columns * goals);
}

}  // namespace

BatchSolver::BatchSolver(InstructionSet level)
    : kernel_(ArmKernelFor(level)), solver_(level) {}

void BatchSolver::Solve(IkProblem& problem,
                        absl::Span<const GoalTarget> targets,
                        const SolverOptions& options, SolveStart start,
                        Eigen::Ref<Eigen::MatrixXd> positions,
                        BatchReport& report, const StopCondition& stop) {
  const int columns = static_cast<int>(positions.cols());
  ResizeReport(columns, problem.goals().size(), report);
  SolverOptions brief = options;
  brief.detail = ReportDetail::kBrief;
  if (problem.arm() == nullptr) {
    for (int c = 0; c < columns; ++c) {
      SolveAlone(problem, targets, brief, start, c, positions, report, stop);
    }
    return;
  }
  for (int begin = 0; begin < columns; begin += kBlock) {
    SolveArms(problem, targets, brief, start, begin,
              std::min(kBlock, columns - begin), positions, report, stop);
  }
}

void BatchSolver::SolveArms(IkProblem& problem,
                            absl::Span<const GoalTarget> targets,
                            const SolverOptions& options, SolveStart start,
                            int begin, int count,
                            Eigen::Ref<Eigen::MatrixXd> positions,
                            BatchReport& report, const StopCondition& stop) {
  const SerialArm& arm = *problem.arm();
  kernel::ArmSettings settings;
  const kernel::TreeLayout tree = problem.tree().Layout();
  arm.Prepare(SettingsFor(problem, tree, options, stop), problem.targets()[0],
              settings);
  arm_targets_.resize(count);
  poses_.resize(count);
  attempts_.resize(count);
  bool takes_all = true;
  for (int i = 0; i < count; ++i) {
    arm.Prepare(targets[begin + i], arm_targets_[i]);
    arm.Gather(positions.col(begin + i), poses_[i]);
    arm.Clamp(settings, poses_[i]);
    takes_all = takes_all && arm.Takes(poses_[i]);
  }
  if (!takes_all) {
    for (int i = begin; i < begin + count; ++i) {
      SolveAlone(problem, targets, options, start, i, positions, report, stop);
    }
    return;
  }
  starts_.assign(poses_.begin(), poses_.end());

  const ArmRequest request = {
      arm,
      settings,
      {tree.lower, size_t(tree.node_count)},
      {tree.upper, size_t(tree.node_count)},
      start,
      std::min(ArmRestartBudget(options, start), kLaneRestarts),
      options.restart_seed};
  // Where they depend on the start they are no use for all.
  const bool restarts =
      request.restart_budget > 0 && !arm.HasFreeSlide(settings);
  const kernel::ArmStarts random = RandomStarts(request, poses_[0]);
  kernel_.descend_many(arm.layout(), settings, restarts ? &random : nullptr,
                       arm_targets_.data(), count, poses_.data(),
                       attempts_.data());
  for (int i = 0; i < count; ++i) {
    const kernel::ArmAttempt& attempt = attempts_[i];
    const int column = begin + i;
    const bool settled = attempt.end == kernel::AttemptEnd::kConverged &&
                         (start == SolveStart::kCold ||
                          LargestMove(arm, starts_[i], poses_[i]) <= kArmJump);
    if (!settled) {
      SolveAlone(problem, targets, options, start, column, positions, report,
                 stop);
      continue;
    }
    ClampToLimits(problem.skeleton(), positions.col(column));
    arm.Scatter(poses_[i], positions.col(column));
    report.outcomes[column] = SolveOutcome::kConverged;
    report.iteration_counts[column] = attempt.iterations;
    report.restart_counts[column] = attempt.drawn;
    report.position_errors_m[column] = std::sqrt(attempt.errors.position2);
    report.rotation_errors_rad[column] = AngleOf(attempt.errors.rotation2);
  }
}

void BatchSolver::SolveAlone(IkProblem& problem,
                             absl::Span<const GoalTarget> targets,
                             const SolverOptions& options, SolveStart start,
                             int column, Eigen::Ref<Eigen::MatrixXd> positions,
                             BatchReport& report, const StopCondition& stop) {
  const size_t goals = problem.goals().size();
  const size_t first = column * goals;
  for (size_t g = 0; g < goals; ++g) {
    problem.SetTarget(static_cast<int>(g), targets[first + g]);
  }
  solver_.Solve(problem, options, start, positions.col(column), alone_, stop);
  report.outcomes[column] = alone_.outcome;
  report.iteration_counts[column] = alone_.iteration_count;
  report.restart_counts[column] = alone_.restart_count;
  std::copy(alone_.position_errors_m.begin(), alone_.position_errors_m.end(),
            report.position_errors_m.begin() + first);
  std::copy(alone_.rotation_errors_rad.begin(),
            alone_.rotation_errors_rad.end(),
            report.rotation_errors_rad.begin() + first);
}

}  // namespace gelenk
