// The closed form of two links (see two_link.h) for skeletons: an end effector
// that two revolute joints about parallel axes move, and nothing else.
//
// The plane may lie anywhere and turn with what carries it; fixed joints may
// stand before, between and after the two. What the target lies off the plane
// of the effector counts as distance. Of several solutions the one within
// limits that is nearest to the start, by whole turns if need be; out of reach
// or of the limits the nearest pose. Exact: no iterations, no tolerance decides
// how near it gets. Allocates nothing but what the report asks for. Cost: some
// 200 ns.
#ifndef GELENK_IK_TWO_LINK_SOLVER_H_
#define GELENK_IK_TWO_LINK_SOLVER_H_

#include <Eigen/Core>

#include "absl/status/status.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/solve_report.h"
#include "gelenk/ik/solver_options.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

class TwoLinkSolver {
 public:
  // INVALID_ARGUMENT naming "method" and why when `problem` is none for two
  // links: it has not exactly one goal, a position along all axes, or the
  // joints that move it are not two revolute ones with parallel axes apart, of
  // their own (none mimics another). Targets and weights do not matter.
  static absl::Status Check(const IkProblem& problem);

  // As LevenbergMarquardtSolver::Solve; `problem` has passed Check.
  void Solve(const IkProblem& problem, const SolverOptions& options,
             VectorView positions, SolveReport& report);

 private:
  Eigen::VectorXd start_;
  Eigen::VectorXd change_;
};

}  // namespace gelenk

#endif  // GELENK_IK_TWO_LINK_SOLVER_H_
