#include "gelenk/ik/ik_solver.h"

#include "gelenk/ik/solver_method.h"
#include "gelenk/ik/stop_condition.h"

namespace gelenk {
namespace {

// What kAuto stands for.
SolverMethod Choose(const SolverOptions& options) {
  return options.method == SolverMethod::kAuto
             ? SolverMethod::kLevenbergMarquardt
             : options.method;
}

struct Deadline {
  IkSolver::Clock clock;
  absl::Duration end;

  static bool IsOver(const void* context) {
    const Deadline& deadline = *static_cast<const Deadline*>(context);
    return deadline.clock() >= deadline.end;
  }
};

}  // namespace

IkSolver::IkSolver(InstructionSet level, Clock clock)
    : clock_(clock), levenberg_marquardt_(level) {}

absl::Status IkSolver::Check(const IkProblem& problem,
                             const SolverOptions& options) {
  const SolverMethod method = Choose(options);
  switch (method) {
    case SolverMethod::kAuto:
    case SolverMethod::kLevenbergMarquardt:
      return absl::OkStatus();
    case SolverMethod::kNewton:
    case SolverMethod::kPseudoInverse:
    case SolverMethod::kMinimalChange:
      return NewtonSolver::Check(problem, method);
    case SolverMethod::kFabrik:
      return FabrikSolver::Check(problem);
    case SolverMethod::kTwoLink:
      return TwoLinkSolver::Check(problem);
  }
  return absl::OkStatus();
}

void IkSolver::Solve(const IkProblem& problem, const SolverOptions& options,
                     SolveStart start, VectorView positions,
                     SolveReport& report, const StepBounds* bounds) {
  Deadline deadline;
  StopCondition stop;
  if (options.time_limit && clock_ != nullptr) {
    deadline = {clock_, clock_() + *options.time_limit};
    stop = {&Deadline::IsOver, &deadline};
  }
  report.method = Choose(options);
  report.kkt_residual = 0;
  switch (report.method) {
    case SolverMethod::kNewton:
      return newton_.Solve(problem, options, positions, report, stop);
    case SolverMethod::kPseudoInverse:
      return pseudo_inverse_.Solve(problem, options, positions, report, stop);
    case SolverMethod::kMinimalChange:
      return minimal_change_.Solve(problem, options, positions, report, stop);
    case SolverMethod::kTwoLink:
      return two_link_.Solve(problem, options, positions, report);
    case SolverMethod::kFabrik:
      return fabrik_.Solve(problem, options, positions, report, stop);
    default:
      return levenberg_marquardt_.Solve(problem, options, start, positions,
                                        report, stop, bounds);
  }
}

}  // namespace gelenk
