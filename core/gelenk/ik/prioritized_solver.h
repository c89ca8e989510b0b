// Goals of several priorities, and goals that no sparse tree takes: the centre
// of mass, and one frame in another of a different branch.
//
// Lexicographic: the first level is solved as if it were alone, by damped least
// squares; each further one in what the levels above leave free, which hold
// what they got to (see LevelDescent). The levels above are disturbed by no
// more than kHeldTolerance, be they met or out of reach and whatever the lower
// ones want. A posture at a level of its own only decides what all others leave
// open.
//
// Dense: cost of an iteration is cubic in the rows of the levels above and
// linear in the degrees of freedom (see LevelStep); sparse problems of one
// level are for LevenbergMarquardtSolver. Local, like that one: of poses that
// meet the first level equally well it takes the one that its start leads to,
// though another might have served the next level better. Only a cold start,
// which draws other starts when a goal is missed, looks further.
//
// Deterministic. Keeps its memory: a solve of a problem no larger than an
// earlier one allocates nothing. Not thread-safe: one per thread.
#ifndef GELENK_IK_PRIORITIZED_SOLVER_H_
#define GELENK_IK_PRIORITIZED_SOLVER_H_

#include <vector>

#include "gelenk/ik/goal_levels.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/level_descent.h"
#include "gelenk/ik/solve_report.h"
#include "gelenk/ik/solver_options.h"
#include "gelenk/ik/step_bounds.h"
#include "gelenk/ik/step_space.h"
#include "gelenk/ik/stop_condition.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

class PrioritizedSolver {
 public:
  // As LevenbergMarquardtSolver::Solve, with options.max_iterations for each
  // level of an attempt. The outcome is that of the first level that is missed.
  void Solve(const IkProblem& problem, const SolverOptions& options,
             SolveStart start, VectorView positions, SolveReport& report,
             const StopCondition& stop = {},
             const StepBounds* bounds = nullptr);

 private:
  // How far the levels of an attempt got.
  struct Levels {
    kernel::AttemptEnd end = kernel::AttemptEnd::kIterations;
    bool pushed_at_limit = false;
    std::vector<double> energies;
  };

  // All levels from `positions`; with a `best` only as long as it is no worse.
  void Run(const SolverOptions& options, LevelSettings settings,
           const Levels* best, VectorView positions, Levels& levels,
           SolveReport& report);
  void Restart(const IkProblem& problem, const SolverOptions& options,
               int budget, LevelSettings settings, VectorView positions,
               SolveReport& report);
  void Report(const IkProblem& problem, const SolverOptions& options,
              const ConstVectorView& positions, SolveReport& report);

  GoalLevels goals_;
  StepSpace space_;
  LevelDescent descent_;
  Levels levels_;
  Levels best_levels_;
  std::vector<double> start_;
  std::vector<double> best_;
  std::vector<double> change_;
  std::vector<int> moving_joints_;
};

}  // namespace gelenk

#endif  // GELENK_IK_PRIORITIZED_SOLVER_H_
