// How to solve. Budgets are counted, never timed: the same request gives the
// same answer on a busy machine.
#ifndef GELENK_IK_SOLVER_OPTIONS_H_
#define GELENK_IK_SOLVER_OPTIONS_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "gelenk/ik/solver_method.h"

namespace gelenk {

// Whether the start is the last answer of a stream or comes from nowhere.
enum class SolveStart { kWarm, kCold };

// How much of SolveReport to fill in.
enum class ReportDetail {
  kBrief,
  // Adds a pass over the joints: about 20 ns a joint.
  kWhole,
  // Adds a decomposition of the Jacobian, about ten iterations' worth of time,
  // and allocates.
  kDiagnosis,
};

// A pose on the way to the answer.
struct Iterate {
  Eigen::VectorXd positions;
  // Length of the weighted residual of all goals.
  double residual = 0;
};

struct SolverOptions {
  SolverMethod method = SolverMethod::kAuto;
  // Per attempt, and with priorities per level of it. When no restart converges
  // the best pose gets one more attempt, with four times as many.
  int max_iterations = 50;
  // Attempts from other starts when one does not converge; unset means
  // kColdRestarts (of an arm kArmColdRestarts) from a cold start and none from
  // a warm one.
  std::optional<int> max_restarts;
  // Seed of those starts.
  int64_t restart_seed = 0;
  // Errors that count as reached.
  double position_tolerance_m = 1e-4;
  double rotation_tolerance_rad = 1e-3;
  ReportDetail detail = ReportDetail::kWhole;
  // Largest change of one degree of freedom in a solve from a warm start, rad
  // or m; see StepBounds. Levenberg-Marquardt only.
  std::optional<double> max_step;
  // Sessions only: keep JointLimits::max_velocity and max_acceleration between
  // frames. Levenberg-Marquardt only.
  bool limit_speed = false;
  // An interactive guard, honoured where the solver was given a clock. Answers
  // that hit it do not repeat.
  std::optional<absl::Duration> time_limit;
  // Not owned; receives the poses on the way where the method has few of them:
  // Newton, pseudo-inverse and minimal change. Null: nobody asks.
  std::vector<Iterate>* iterates = nullptr;
};

inline constexpr int kColdRestarts = 40;
// A budget above these is a mistake or an attack: a frame of it would hold a
// core for seconds.
inline constexpr int kMaxIterations = 1000;
inline constexpr int kMaxRestarts = 1000;
inline constexpr int kMaxTotalIterations = 50000;

// INVALID_ARGUMENT naming each field out of range.
absl::Status CheckSolverOptions(const SolverOptions& options);

inline int RestartBudget(const SolverOptions& options, SolveStart start) {
  return options.max_restarts.value_or(
      start == SolveStart::kCold ? kColdRestarts : 0);
}

}  // namespace gelenk

#endif  // GELENK_IK_SOLVER_OPTIONS_H_
