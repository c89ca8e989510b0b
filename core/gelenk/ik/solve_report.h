// What a solver did. A solve that ran is not an error, reached or not.
#ifndef GELENK_IK_SOLVE_REPORT_H_
#define GELENK_IK_SOLVE_REPORT_H_

#include <vector>

#include "gelenk/ik/solver_method.h"

namespace gelenk {

enum class SolveOutcome {
  // Every goal within tolerance.
  kConverged,
  // Out of reach: the pose is the closest found, the errors are the distances.
  kUnreachable,
  // Joints on their limits keep it from getting closer.
  kStalledAtLimits,
  // The Jacobian lost rank and the method cannot go on; the pose so far.
  kSingular,
  // Iterations and restarts used up.
  kIterationLimit,
  // Told to stop; the best pose so far.
  kTimeLimit,
};

struct SolveReport {
  SolveOutcome outcome = SolveOutcome::kConverged;
  // What ran; never kAuto.
  SolverMethod method = SolverMethod::kLevenbergMarquardt;
  int iteration_count = 0;
  int restart_count = 0;
  // Per goal, in order of the problem: distance to the target along the axes
  // that count, m, and angle to it, rad; 0 where the goal has none or is off.
  std::vector<double> position_errors_m;
  std::vector<double> rotation_errors_rad;

  // From here on only with ReportDetail::kWhole.
  // Indices of joints that move a goal and are on a limit, ascending.
  std::vector<int> limited_joints;
  // Length of the change from the start in the stiffness metric.
  double change = 0;
  // Minimal change only: how far the result is from the nearest solution as far
  // as the Jacobian shows, the length of (I - J^+ J)(q_old - q) in the metric
  // of `change`. 0 for other methods.
  double kkt_residual = 0;

  // From here on only with ReportDetail::kDiagnosis.
  // Rank of the task Jacobian at the result, its singular values cut off at
  // kRankCutoff of the largest.
  int rank = 0;
  // Degrees of freedom that no goal determines: velocity_count - rank.
  int free_velocity_count = 0;
  // sqrt(det(J J^T)) of translation and rotation rows of all goals; 0 with
  // fewer columns than rows, or without such rows.
  double translation_manipulability = 0;
  double rotation_manipulability = 0;
};

}  // namespace gelenk

#endif  // GELENK_IK_SOLVE_REPORT_H_
