// Solving a few goals once, for the tests of their kinds.
#ifndef GELENK_TESTS_CORE_IK_GOALS_SOLVE_GOALS_H_
#define GELENK_TESTS_CORE_IK_GOALS_SOLVE_GOALS_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/solve_report.h"
#include "gelenk/ik/solver_options.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::testing {

struct Solved {
  Eigen::VectorXd positions;
  SolveReport report;
};

// With a fresh solver, from a warm start.
Solved SolveGoals(const std::shared_ptr<const Skeleton>& skeleton,
                  std::vector<Goal> goals, const Eigen::VectorXd& start,
                  const SolverOptions& options = {});

// A goal of that kind, called "goal".
Goal GoalOf(const GoalKind& kind, double weight = 1, int priority = 0);

// Ball joints "hip" (at the origin), "knee", "ankle" 0.45 and 0.4 m apart along
// -Y, the sole 0.1 m further; a bend of the knee that is a hinge about X if
// `hinge`, 0 to 2.5 rad, which moves the ankle towards -Z.
std::shared_ptr<const Skeleton> Leg(bool hinge);

// Positions of Leg with the thigh `swing_rad` forward about X, and the hinge
// `bend_rad` bent.
Eigen::VectorXd HingedLegAt(double swing_rad, double bend_rad);

Eigen::Vector3d OriginOf(const Skeleton& skeleton,
                         const Eigen::VectorXd& positions,
                         absl::string_view id);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_CORE_IK_GOALS_SOLVE_GOALS_H_
