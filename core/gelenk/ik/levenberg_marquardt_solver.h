// The default inverse kinematics: damped least squares on the manifold of
// poses, with limits inside the step.
//
// Each iteration linearises all goals, freezes the coordinates that sit at a
// bound and are pushed outwards, and takes the Levenberg-Marquardt step
//   (J^T J + lambda S) dq = J^T e,  lambda = c E + floor,
// S the joints' stiffness, E half the weighted squared error (Sugihara,
// "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt
// method", 2011). The normal matrix is factorised on the tree, leaf first,
// without fill-in. A cold start that gets nowhere is given up early and tried
// from another start.
//
// It goes level by level, by PrioritizedSolver, where the problem needs that,
// and where a long step threw a point far beyond the plane that it was to come
// to.
//
// Deterministic: the answer depends on the problem, the options, the start and
// the instruction set, on nothing else. Allocates nothing once it has seen a
// problem of that size. Not thread-safe: one solver per thread; it holds the
// working memory, so that problems need not.
#ifndef GELENK_IK_LEVENBERG_MARQUARDT_SOLVER_H_
#define GELENK_IK_LEVENBERG_MARQUARDT_SOLVER_H_

#include <cstdint>
#include <vector>

#include "absl/functional/function_ref.h"
#include "gelenk/ik/bone_chain.h"
#include "gelenk/ik/column_bounds.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/instruction_set.h"
#include "gelenk/ik/kernel/arm_layout.h"
#include "gelenk/ik/kernel/chain_layout.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/prioritized_solver.h"
#include "gelenk/ik/solve_report.h"
#include "gelenk/ik/solver_options.h"
#include "gelenk/ik/step_bounds.h"
#include "gelenk/ik/stop_condition.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

class LevenbergMarquardtSolver {
 public:
  // `level` must be supported; see SupportedInstructionSets.
  explicit LevenbergMarquardtSolver(
      InstructionSet level = BestInstructionSet());

  // Moves `positions` (size position_count, checked) from the start to the
  // solution. A start outside its limits is first moved to the nearest pose
  // inside. On any outcome but kConverged the result is the closest pose found.
  // Joints that move no goal stay where they are. Quaternions stay in the
  // hemisphere of the start. `options` must have passed CheckSolverOptions.
  // Bounds of the move, from options.max_step and `bounds` (may be null), count
  // for a warm start, which then has no restarts; they hold from the start once
  // it is inside its limits.
  void Solve(const IkProblem& problem, const SolverOptions& options,
             SolveStart start, VectorView positions, SolveReport& report,
             const StopCondition& stop = {},
             const StepBounds* bounds = nullptr);

  InstructionSet instruction_set() const { return level_; }

 private:
  // Puts the bounds of a frame into settings.
  using Narrow =
      absl::FunctionRef<void(const kernel::TreeLayout&, kernel::Settings&)>;

  // All goals at once.
  void SolveAtOnce(const IkProblem& problem, const SolverOptions& options,
                   SolveStart start, VectorView positions, SolveReport& report,
                   const StopCondition& stop, const StepBounds* bounds);
  // By the kernels of arms; false, and nothing done, where they do not take the
  // start.
  bool SolveAsArm(const IkProblem& problem, const SerialArm& arm,
                  const SolverOptions& options, SolveStart start,
                  VectorView positions, SolveReport& report,
                  const StopCondition& stop, const Narrow& narrow);
  void Reserve(const IkProblem& problem, const kernel::TreeLayout& tree);
  // One attempt, by the kernel that fits the problem.
  kernel::Attempt Run(const IkProblem& problem, const kernel::TreeLayout& tree,
                      const kernel::Settings& settings, VectorView positions);
  // Where a chain without limits cannot reach its target it reaches out for it,
  // in closed form: true then. Steps would take long to stretch it.
  bool ReachOut(const IkProblem& problem, const kernel::TreeLayout& tree,
                kernel::Settings settings, VectorView positions,
                kernel::Attempt& attempt);
  // The joints that move a goal that is on.
  void FindMovingJoints(const IkProblem& problem,
                        const kernel::TreeLayout& tree);
  kernel::Attempt Restart(const IkProblem& problem, kernel::Settings settings,
                          int budget, int64_t seed, kernel::Attempt attempt,
                          VectorView positions, SolveReport& report);
  // Of goal t.
  static void ReportErrors(int t, double position2, double rotation2,
                           SolveReport& report);
  // What options.detail adds.
  void ReportDetails(const IkProblem& problem, const SolverOptions& options,
                     const kernel::TreeLayout& tree,
                     const ConstVectorView& positions, SolveReport& report);

  InstructionSet level_;
  kernel::AttemptFunction attempt_;
  kernel::ArmKernel arm_kernel_;
  kernel::ChainFunction run_chain_;
  // Grow to the largest problem seen and stay.
  std::vector<double> memory_;
  kernel::Workspace workspace_ = {};
  kernel::ChainWorkspace chain_workspace_ = {};
  // Of the problem that is solved, where the kernel of chains fits.
  const SerialChain* chain_ = nullptr;
  ColumnBounds bounds_;
  // With plants captured, where the problem has free ones.
  std::vector<kernel::TaskTarget> targets_;
  BonePose bone_pose_;
  std::vector<double> start_;
  std::vector<double> best_;
  std::vector<double> change_;
  std::vector<uint8_t> moves_;  // per joint
  std::vector<int> moving_joints_;
  PrioritizedSolver prioritized_;
};

}  // namespace gelenk

#endif  // GELENK_IK_LEVENBERG_MARQUARDT_SOLVER_H_
