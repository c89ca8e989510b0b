// The three methods of Newton's kind, of growing strength, on g(q) = 0 (see
// GoalEquations), q in the manifold of poses:
//
//   inverse          q <- q - Dg^-1 g: as many equations as unknowns; a
//                    singular Dg ends it with kSingular at the pose so far.
//   pseudo-inverse   q <- q - J^+ g: each step is the smallest that meets the
//                    linearised equations, by least squares where they cannot
//                    be met; the sum of the steps is not the smallest change.
//   minimal change   q <- q - J^+ g + (I - J^+ J)(q_old - q): ends where g = 0
//                    and the change has no part left in the null space, the
//                    condition for the smallest change among the solutions.
//                    The part in the null space is shortened when it grew in
//                    the last step, for it may overshoot where the solutions
//                    are strongly curved; its zeros stay the same.
//
// "Small" is measured by the joints' stiffness: sum of s_i dq_i^2, and J^+ is
// weighted to match. Steps are neither damped nor turned back: these are the
// textbook's methods, for study, for exactness (they converge quadratically)
// and for the smallest change. The default method is for everything else.
//
// Limits: a coordinate at a bound that would leave is held, and the step taken
// without it; after the step every coordinate is moved to the nearest value
// inside its limits. Such a step is no longer the textbook's; where the way on
// leads through a limit, the outcome is kStalledAtLimits. Frozen coordinates
// are no unknowns. Unreachable goals: the pseudo-inverse settles at the least
// squares and says kUnreachable, or swings about them until the iterations are
// used up; the answer is the best pose seen.
//
// Deterministic. No restarts. Allocates. Cost per iteration: one singular value
// decomposition of J.
#ifndef GELENK_IK_NEWTON_SOLVER_H_
#define GELENK_IK_NEWTON_SOLVER_H_

#include "absl/status/status.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/solve_report.h"
#include "gelenk/ik/solver_method.h"
#include "gelenk/ik/solver_options.h"
#include "gelenk/ik/stop_condition.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

// Minimal change has converged when, besides the goals, what is left of the
// change in the null space is shorter than this, in the metric of
// SolveReport::change.
inline constexpr double kKktTolerance = 1e-9;

class NewtonSolver {
 public:
  // `method` is kNewton, kPseudoInverse or kMinimalChange.
  explicit NewtonSolver(SolverMethod method) : method_(method) {}

  // INVALID_ARGUMENT naming "method" when the goals are of other kinds than
  // GoalEquations takes, or for kNewton when there are not as many equations as
  // unknowns. Goals count whether on or off; with one switched off kNewton has
  // too few equations and ends with kSingular.
  static absl::Status Check(const IkProblem& problem, SolverMethod method);

  // As LevenbergMarquardtSolver::Solve; problem and method have passed Check.
  // With options.iterates every pose on the way is recorded, the start first.
  void Solve(const IkProblem& problem, const SolverOptions& options,
             VectorView positions, SolveReport& report,
             const StopCondition& stop = {});

 private:
  SolverMethod method_;
};

}  // namespace gelenk

#endif  // GELENK_IK_NEWTON_SOLVER_H_
