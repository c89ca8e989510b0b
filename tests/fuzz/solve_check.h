// What must hold of every solve, whatever was asked for.
#ifndef GELENK_TESTS_FUZZ_SOLVE_CHECK_H_
#define GELENK_TESTS_FUZZ_SOLVE_CHECK_H_

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/ik/batch_solver.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/ik_solver.h"
#include "gelenk/skeleton/pose.h"
#include "tests/fuzz/fuzz_check.h"

namespace gelenk {

inline bool SameBits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() &&
         (a.size() == 0 ||
          std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

// A pose of `skeleton`: finite, quaternions unit, inside the limits but for
// rounding.
inline void CheckPose(const Skeleton& skeleton, Eigen::VectorXd positions) {
  GELENK_FUZZ_CHECK(positions.allFinite());
  GELENK_FUZZ_CHECK(CheckPositions(skeleton, positions).ok());
  const double size =
      positions.size() == 0 ? 0 : positions.cwiseAbs().maxCoeff();
  GELENK_FUZZ_CHECK(LimitExcess(skeleton, positions, nullptr) <=
                    1e-9 * std::max(1.0, size));
}

// What an outcome says of the errors of the goals at `weights` that are on.
inline void CheckErrors(const IkProblem& problem, const SolverOptions& options,
                        SolveOutcome outcome,
                        absl::Span<const double> position_errors_m,
                        absl::Span<const double> rotation_errors_rad) {
  const size_t goals = problem.goals().size();
  GELENK_FUZZ_CHECK(position_errors_m.size() == goals);
  GELENK_FUZZ_CHECK(rotation_errors_rad.size() == goals);
  for (size_t g = 0; g < goals; ++g) {
    const double position = position_errors_m[g];
    const double rotation = rotation_errors_rad[g];
    GELENK_FUZZ_CHECK(std::isfinite(position) && position >= 0);
    GELENK_FUZZ_CHECK(std::isfinite(rotation) && rotation >= 0);
    if (outcome != SolveOutcome::kConverged) continue;
    GELENK_FUZZ_CHECK(position <= options.position_tolerance_m * (1 + 1e-9));
    GELENK_FUZZ_CHECK(rotation <= options.rotation_tolerance_rad * (1 + 1e-9));
  }
}

inline void CheckReport(const IkProblem& problem, const SolverOptions& options,
                        const SolveReport& report) {
  CheckErrors(problem, options, report.outcome, report.position_errors_m,
              report.rotation_errors_rad);
  GELENK_FUZZ_CHECK(report.method != SolverMethod::kAuto);
  GELENK_FUZZ_CHECK(report.iteration_count >= 0 && report.restart_count >= 0);
  if (options.max_restarts) {
    GELENK_FUZZ_CHECK(report.restart_count <= *options.max_restarts);
  }
  if (options.detail == ReportDetail::kBrief) return;
  GELENK_FUZZ_CHECK(std::isfinite(report.change) && report.change >= 0);
  GELENK_FUZZ_CHECK(std::isfinite(report.kkt_residual));
  int last = -1;
  for (int joint : report.limited_joints) {
    GELENK_FUZZ_CHECK(joint > last && joint < problem.skeleton().joint_count());
    last = joint;
  }
  if (options.detail != ReportDetail::kDiagnosis) return;
  const int columns = problem.skeleton().velocity_count();
  GELENK_FUZZ_CHECK(report.rank >= 0 && report.rank <= columns);
  GELENK_FUZZ_CHECK(report.free_velocity_count == columns - report.rank);
  GELENK_FUZZ_CHECK(std::isfinite(report.translation_manipulability));
  GELENK_FUZZ_CHECK(std::isfinite(report.rotation_manipulability));
}

// Solves from `start`, checked, twice: the answer does not depend on what the
// solver has done before. Returns it.
inline Eigen::VectorXd CheckSolve(IkSolver& solver, const IkProblem& problem,
                                  const SolverOptions& options, SolveStart from,
                                  const Eigen::VectorXd& start) {
  SolveReport report;
  Eigen::VectorXd positions = start;
  solver.Solve(problem, options, from, positions, report);
  CheckPose(problem.skeleton(), positions);
  CheckReport(problem, options, report);
  SolveReport report_again;
  Eigen::VectorXd again = start;
  IkSolver(solver.instruction_set())
      .Solve(problem, options, from, again, report_again);
  GELENK_FUZZ_CHECK(SameBits(positions, again));
  GELENK_FUZZ_CHECK(report.outcome == report_again.outcome);
  GELENK_FUZZ_CHECK(report.iteration_count == report_again.iteration_count);
  return positions;
}

// The problem's own targets from each column of `starts`.
inline void CheckBatch(IkProblem& problem, const SolverOptions& options,
                       SolveStart from, const Eigen::MatrixXd& starts) {
  std::vector<GoalTarget> targets;
  for (int c = 0; c < starts.cols(); ++c) {
    for (const Goal& goal : problem.goals()) {
      targets.push_back(TargetOf(goal.kind));
    }
  }
  BatchReport report;
  Eigen::MatrixXd positions = starts;
  BatchSolver().Solve(problem, targets, options, from, positions, report);
  const size_t goals = problem.goals().size();
  for (int c = 0; c < starts.cols(); ++c) {
    CheckPose(problem.skeleton(), positions.col(c));
    CheckErrors(
        problem, options, report.outcomes[c],
        absl::MakeSpan(report.position_errors_m).subspan(c * goals, goals),
        absl::MakeSpan(report.rotation_errors_rad).subspan(c * goals, goals));
  }
}

}  // namespace gelenk

#endif  // GELENK_TESTS_FUZZ_SOLVE_CHECK_H_
