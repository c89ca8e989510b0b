// Inverse kinematics by any method: what sessions and calls solve with.
//
// Owns a solver of each method, made when it is first needed, and with it their
// working memory. Not thread-safe: one per thread. Deterministic unless a time
// limit strikes. Levenberg-Marquardt allocates nothing once it has seen a
// problem of that size; the others say for themselves.
#ifndef GELENK_IK_IK_SOLVER_H_
#define GELENK_IK_IK_SOLVER_H_

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "gelenk/ik/fabrik_solver.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/instruction_set.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/ik/newton_solver.h"
#include "gelenk/ik/solve_report.h"
#include "gelenk/ik/solver_options.h"
#include "gelenk/ik/step_bounds.h"
#include "gelenk/ik/stop_condition.h"
#include "gelenk/ik/two_link_solver.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

class IkSolver {
 public:
  // Time since any moment; never goes back.
  using Clock = absl::Duration (*)();

  // `level` must be supported; see SupportedInstructionSets. Without a clock
  // SolverOptions::time_limit is not honoured.
  explicit IkSolver(InstructionSet level = BestInstructionSet(),
                    Clock clock = nullptr);

  // INVALID_ARGUMENT naming "method" when the method that `options` ask for
  // does not fit `problem`. Depends on the goals' kinds and masks, on neither
  // targets nor weights: what passed once stays fit from frame to frame.
  static absl::Status Check(const IkProblem& problem,
                            const SolverOptions& options);

  // Moves `positions` (size position_count, checked) from the start to the
  // solution; report.method says what ran. `options` must have passed
  // CheckSolverOptions, both together Check. `bounds` may be null.
  void Solve(const IkProblem& problem, const SolverOptions& options,
             SolveStart start, VectorView positions, SolveReport& report,
             const StepBounds* bounds = nullptr);

  InstructionSet instruction_set() const {
    return levenberg_marquardt_.instruction_set();
  }

 private:
  Clock clock_;
  LevenbergMarquardtSolver levenberg_marquardt_;
  NewtonSolver newton_{SolverMethod::kNewton};
  NewtonSolver pseudo_inverse_{SolverMethod::kPseudoInverse};
  NewtonSolver minimal_change_{SolverMethod::kMinimalChange};
  FabrikSolver fabrik_;
  TwoLinkSolver two_link_;
};

}  // namespace gelenk

#endif  // GELENK_IK_IK_SOLVER_H_
