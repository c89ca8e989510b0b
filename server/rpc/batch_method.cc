#include "server/rpc/batch_method.h"

#include <utility>
#include <variant>
#include <vector>

#include "absl/strings/str_cat.h"
#include "convert/duration.h"
#include "convert/goal.h"
#include "convert/solver.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/batch_solver.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"
#include "server/clock.h"
#include "server/rpc/find_skeleton.h"
#include "server/rpc/unary_call.h"

namespace gelenk::server {
namespace {

using Service = v1::KinematicsService::AsyncService;

// Numbers of a goal's target in the packed array; 0 for kinds that have none.
int TargetSize(const Goal& goal) {
  const GoalTarget target = TargetOf(goal.kind);
  if (std::holds_alternative<Eigen::Vector3d>(target)) return 3;
  if (std::holds_alternative<Eigen::Quaterniond>(target)) return 4;
  return std::holds_alternative<RigidTransform>(target) ? 7 : 0;
}

GoalTarget ReadTarget(int size, const double* numbers) {
  if (size == 3) return Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
  if (size == 4) return QuaternionXyzw(numbers);
  return RigidTransform{QuaternionXyzw(numbers + 3),
                        Eigen::Vector3d(numbers[0], numbers[1], numbers[2])};
}

// The targets of all problems, checked.
std::vector<GoalTarget> ReadTargets(const IkProblem& problem,
                                    const v1::BatchSolveRequest& request,
                                    Violations& violations) {
  std::vector<int> sizes;
  int problem_size = 0;
  for (size_t g = 0; g < problem.goals().size(); ++g) {
    sizes.push_back(TargetSize(problem.goals()[g]));
    problem_size += sizes.back();
    if (sizes.back() > 0) continue;
    violations.Add(absl::StrCat("goals[", g, "]"),
                   absl::StrCat(GoalKindName(problem.goals()[g].kind),
                                " goals have no target in a batch"));
  }
  std::vector<GoalTarget> targets;
  if (!violations.empty()) return targets;
  const int count = request.targets_size();
  if (count == 0 || problem_size == 0 || count % problem_size != 0 ||
      count / problem_size > kMaxBatchProblems) {
    violations.Add(
        "targets",
        absl::StrCat("want ", problem_size, " numbers for each of 1 to ",
                     kMaxBatchProblems, " problems, got ", count));
    return targets;
  }
  const double* numbers = request.targets().data();
  for (int at = 0; at < count;) {
    for (size_t g = 0; g < sizes.size(); ++g) {
      GoalTarget target = ReadTarget(sizes[g], numbers + at);
      violations.AddStatus(absl::StrCat("targets[", at, "]"),
                           problem.CheckTarget(static_cast<int>(g), target));
      targets.push_back(std::move(target));
      at += sizes[g];
    }
  }
  return targets;
}

// A column a problem.
Eigen::MatrixXd ReadStarts(const Skeleton& skeleton,
                           const v1::BatchSolveRequest& request, int problems,
                           Violations& violations) {
  const int size = skeleton.position_count();
  const int count = request.start_positions_size();
  if (count == 0) return skeleton.rest_positions().replicate(1, problems);
  if (count != size && int64_t{count} != int64_t{size} * problems) {
    violations.Add(
        "start_positions",
        absl::StrCat("want none, ", size, " numbers, or ", size,
                     " for each of ", problems, " problems, got ", count));
    return {};
  }
  const bool shared = count == size;
  Eigen::MatrixXd starts = Eigen::Map<const Eigen::MatrixXd>(
      request.start_positions().data(), size, shared ? 1 : problems);
  for (int column = 0; column < starts.cols(); ++column) {
    violations.AddStatus(absl::StrCat("start_positions[", column * size, "]"),
                         CheckPositions(skeleton, starts.col(column)));
  }
  if (shared) return starts.replicate(1, problems);
  return starts;
}

void ToProto(const BatchReport& report, const Eigen::MatrixXd& positions,
             v1::BatchSolveResponse* response) {
  response->mutable_positions()->Add(positions.data(),
                                     positions.data() + positions.size());
  for (SolveOutcome outcome : report.outcomes) {
    response->add_outcomes(convert::OutcomeToProto(outcome));
  }
  response->mutable_iteration_counts()->Add(report.iteration_counts.begin(),
                                            report.iteration_counts.end());
  response->mutable_restart_counts()->Add(report.restart_counts.begin(),
                                          report.restart_counts.end());
  response->mutable_position_errors_m()->Add(report.position_errors_m.begin(),
                                             report.position_errors_m.end());
  response->mutable_rotation_errors_rad()->Add(
      report.rotation_errors_rad.begin(), report.rotation_errors_rad.end());
}

absl::Status BatchSolve(const ServiceState& state,
                        const v1::BatchSolveRequest& request,
                        v1::BatchSolveResponse* response) {
  absl::StatusOr<StoredSkeleton> stored =
      FindSkeleton(state, "skeleton", request.skeleton());
  if (!stored.ok()) return stored.status();
  Violations violations;
  absl::StatusOr<SolverOptions> options =
      convert::FromProto(request.solver_options());
  violations.AddStatus("solver_options", options.status());
  if (options.ok() && options->method != SolverMethod::kAuto &&
      options->method != SolverMethod::kLevenbergMarquardt) {
    violations.Add("solver_options.method",
                   absl::StrCat(SolverMethodName(options->method),
                                " does not solve batches"));
  }
  absl::StatusOr<std::vector<Goal>> goals =
      convert::FromProto(request.goals(), stored->skeleton.get());
  violations.AddStatus("", goals.status());
  if (!violations.empty()) return violations.ToStatus();
  absl::StatusOr<IkProblem> problem =
      stored->trees->CreateProblem(*std::move(goals), *options);
  if (!problem.ok()) return problem.status();
  const std::vector<GoalTarget> targets =
      ReadTargets(*problem, request, violations);
  if (!violations.empty()) return violations.ToStatus();
  const int problems =
      static_cast<int>(targets.size() / problem->goals().size());
  Eigen::MatrixXd positions =
      ReadStarts(problem->skeleton(), request, problems, violations);
  if (!violations.empty()) return violations.ToStatus();

  const bool cold = request.cold() || request.start_positions_size() == 0;
  BatchSolver solver(state.options.instruction_set);
  BatchReport report;
  const absl::Time begin = Now();
  solver.Solve(*problem, targets, *options,
               cold ? SolveStart::kCold : SolveStart::kWarm, positions, report);
  convert::ToProto(Now() - begin, response->mutable_solve_duration());
  ToProto(report, positions, response);
  return absl::OkStatus();
}

}  // namespace

void ServeBatch(Service* service, ServiceState* state, IoThread* thread) {
  ServeUnary(
      service, &Service::RequestBatchSolve,
      [state](IkSolver&, const v1::BatchSolveRequest& request,
              v1::BatchSolveResponse* response) {
        return BatchSolve(*state, request, response);
      },
      state, thread);
}

}  // namespace gelenk::server
