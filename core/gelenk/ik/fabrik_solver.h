// FABRIK: inverse kinematics of chains that reach for a point, on points.
//
// Each sweep pulls the chain by its tip to the target and then by its root back
// to where it stands, bone by bone, keeping their lengths (Aristidou and
// Lasenby, "FABRIK: a fast, iterative solver for the inverse kinematics
// problem", 2011). The joints then turn by as little as makes the bones point
// that way. A target out of reach is answered in closed form: straight at it,
// or folded up. A chain that lies on the line to its target, which no sweep
// would ever leave, is bent first.
//
// Without limits only: with them LevenbergMarquardtSolver is as fast, and
// exact.
//
// Deterministic; no start but the given one is tried. Allocates nothing once it
// has seen a chain of that length. Not thread-safe. Cost: about 10 ns a bone
// and sweep, and 30 ns a joint.
#ifndef GELENK_IK_FABRIK_SOLVER_H_
#define GELENK_IK_FABRIK_SOLVER_H_

#include <Eigen/Core>
#include <vector>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "gelenk/ik/bone_chain.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/solve_report.h"
#include "gelenk/ik/solver_options.h"
#include "gelenk/ik/stop_condition.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

// Sweeps that SolverOptions::max_iterations allows for each iteration: they
// cost as much less.
inline constexpr int kSweepsPerIteration = 10;

class FabrikSolver {
 public:
  // INVALID_ARGUMENT naming "method" and why when `problem` is none for FABRIK:
  // it has not exactly one goal, a position along all axes, or see BoneChain.
  // Weights do not matter, nor do targets.
  static absl::Status Check(const IkProblem& problem);

  // Moves `positions` (size position_count, checked) from the start to the
  // solution, or as near as it gets. report.iteration_count is the number of
  // sweeps. `problem` must have passed Check, `options` CheckSolverOptions.
  void Solve(const IkProblem& problem, const SolverOptions& options,
             VectorView positions, SolveReport& report,
             const StopCondition& stop = {});

 private:
  // Bows the points towards unit vector `aside`, perpendicular to `direction`,
  // if they lie on a line along that.
  void Bend(const Eigen::Vector3d& direction, const Eigen::Vector3d& aside,
            double length);
  // Once there and back. Bones without a direction take `aside`.
  void Sweep(absl::Span<const double> lengths, const Eigen::Vector3d& last,
             const Eigen::Vector3d& aside);
  // Points and joints to the target of a goal that is on.
  void Reach(const IkProblem& problem, const SolverOptions& options,
             VectorView positions, SolveReport& report,
             const StopCondition& stop);
  void FinishReport(const IkProblem& problem, const SolverOptions& options,
                    const ConstVectorView& positions, SolveReport& report);

  BonePose pose_;
  Eigen::VectorXd start_;
  Eigen::VectorXd change_;
};

}  // namespace gelenk

#endif  // GELENK_IK_FABRIK_SOLVER_H_
