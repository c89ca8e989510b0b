// One problem for many targets at once, for the most answers in a time: a robot
// cell's reach, a dataset, a planner's candidates.
//
//   BatchSolver solver;
//   Eigen::MatrixXd positions = start.replicate(1, count);  // a column a
//   target BatchReport report; solver.Solve(problem, targets, options,
//   SolveStart::kCold, positions,
//                report);
//
// Arms (see SerialArm) are solved as many side by side as a vector register has
// lanes, a new target taking the lane of one that is done; what is not settled
// there, and every other problem, is left to LevenbergMarquardtSolver, one by
// one. So each answer is as good as one of its own: all that Solve of
// LevenbergMarquardtSolver promises holds. Which of several solutions a cold
// arm finds may differ where the start itself leads to none.
//
// Deterministic: an answer does not depend on its neighbours. Allocates nothing
// once it has seen a batch of that size, except in the report. Not thread-safe.
#ifndef GELENK_IK_BATCH_SOLVER_H_
#define GELENK_IK_BATCH_SOLVER_H_

#include <Eigen/Core>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/ik/goal.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/instruction_set.h"
#include "gelenk/ik/kernel/arm_layout.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/ik/solve_report.h"
#include "gelenk/ik/solver_options.h"
#include "gelenk/ik/stop_condition.h"

namespace gelenk {

// As in SolveReport, one a problem; errors one a problem and goal, the goals of
// a problem side by side.
struct BatchReport {
  std::vector<SolveOutcome> outcomes;
  std::vector<int> iteration_counts;
  std::vector<int> restart_counts;
  std::vector<double> position_errors_m;
  std::vector<double> rotation_errors_rad;
};

class BatchSolver {
 public:
  // `level` must be supported; see SupportedInstructionSets.
  explicit BatchSolver(InstructionSet level = BestInstructionSet());

  // Solves `problem` once for each column of `positions` (position_count rows,
  // each column checked), which holds the start and then the answer. `targets`
  // has those of all goals for the first column, then for the second and so on;
  // each has passed CheckTarget. The problem is left with the targets of any
  // column. `options` must have passed CheckSolverOptions; their detail counts
  // as brief.
  void Solve(IkProblem& problem, absl::Span<const GoalTarget> targets,
             const SolverOptions& options, SolveStart start,
             Eigen::Ref<Eigen::MatrixXd> positions, BatchReport& report,
             const StopCondition& stop = {});

  InstructionSet instruction_set() const { return solver_.instruction_set(); }

 private:
  // Columns `begin` to `begin + count` of an arm.
  void SolveArms(IkProblem& problem, absl::Span<const GoalTarget> targets,
                 const SolverOptions& options, SolveStart start, int begin,
                 int count, Eigen::Ref<Eigen::MatrixXd> positions,
                 BatchReport& report, const StopCondition& stop);
  void SolveAlone(IkProblem& problem, absl::Span<const GoalTarget> targets,
                  const SolverOptions& options, SolveStart start, int column,
                  Eigen::Ref<Eigen::MatrixXd> positions, BatchReport& report,
                  const StopCondition& stop);

  kernel::ArmKernel kernel_;
  LevenbergMarquardtSolver solver_;
  SolveReport alone_;
  // Of one block of arms.
  std::vector<kernel::ArmTarget> arm_targets_;
  std::vector<kernel::ArmRow> starts_;
  std::vector<kernel::ArmRow> poses_;
  std::vector<kernel::ArmAttempt> attempts_;
};

}  // namespace gelenk

#endif  // GELENK_IK_BATCH_SOLVER_H_
