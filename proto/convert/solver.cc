#include "convert/solver.h"

#include <optional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "convert/duration.h"
#include "gelenk/base/violations.h"

namespace gelenk::convert {
namespace {

v1::SolverMethod ToProto(SolverMethod method) {
  switch (method) {
    case SolverMethod::kAuto:
      return v1::SOLVER_METHOD_UNSPECIFIED;
    case SolverMethod::kTwoLink:
      return v1::SOLVER_METHOD_TWO_LINK;
    case SolverMethod::kNewton:
      return v1::SOLVER_METHOD_NEWTON;
    case SolverMethod::kPseudoInverse:
      return v1::SOLVER_METHOD_PSEUDO_INVERSE;
    case SolverMethod::kMinimalChange:
      return v1::SOLVER_METHOD_MINIMAL_CHANGE;
    case SolverMethod::kLevenbergMarquardt:
      return v1::SOLVER_METHOD_LEVENBERG_MARQUARDT;
    case SolverMethod::kFabrik:
      return v1::SOLVER_METHOD_FABRIK;
  }
  return v1::SOLVER_METHOD_UNSPECIFIED;
}

std::optional<SolverMethod> FromProto(v1::SolverMethod method) {
  switch (method) {
    case v1::SOLVER_METHOD_UNSPECIFIED:
      return SolverMethod::kAuto;
    case v1::SOLVER_METHOD_TWO_LINK:
      return SolverMethod::kTwoLink;
    case v1::SOLVER_METHOD_NEWTON:
      return SolverMethod::kNewton;
    case v1::SOLVER_METHOD_PSEUDO_INVERSE:
      return SolverMethod::kPseudoInverse;
    case v1::SOLVER_METHOD_MINIMAL_CHANGE:
      return SolverMethod::kMinimalChange;
    case v1::SOLVER_METHOD_LEVENBERG_MARQUARDT:
      return SolverMethod::kLevenbergMarquardt;
    case v1::SOLVER_METHOD_FABRIK:
      return SolverMethod::kFabrik;
    default:
      return std::nullopt;
  }
}

void CopyErrors(const std::vector<double>& errors,
                google::protobuf::RepeatedField<float>* out) {
  out->Resize(static_cast<int>(errors.size()), 0);
  for (size_t i = 0; i < errors.size(); ++i) {
    (*out)[static_cast<int>(i)] = static_cast<float>(errors[i]);
  }
}

}  // namespace

v1::SolveReport::Outcome OutcomeToProto(SolveOutcome outcome) {
  switch (outcome) {
    case SolveOutcome::kConverged:
      return v1::SolveReport::OUTCOME_CONVERGED;
    case SolveOutcome::kUnreachable:
      return v1::SolveReport::OUTCOME_UNREACHABLE;
    case SolveOutcome::kStalledAtLimits:
      return v1::SolveReport::OUTCOME_STALLED_AT_LIMITS;
    case SolveOutcome::kIterationLimit:
      return v1::SolveReport::OUTCOME_ITERATION_LIMIT;
    case SolveOutcome::kSingular:
      return v1::SolveReport::OUTCOME_SINGULAR;
    case SolveOutcome::kTimeLimit:
      return v1::SolveReport::OUTCOME_TIME_LIMIT;
  }
  return v1::SolveReport::OUTCOME_UNSPECIFIED;
}

absl::StatusOr<SolverOptions> FromProto(const v1::SolverOptions& proto) {
  SolverOptions options;
  if (proto.has_max_iterations()) {
    options.max_iterations = proto.max_iterations();
  }
  if (proto.has_max_restarts()) options.max_restarts = proto.max_restarts();
  options.restart_seed = proto.restart_seed();
  if (proto.has_position_tolerance_m()) {
    options.position_tolerance_m = proto.position_tolerance_m();
  }
  if (proto.has_rotation_tolerance_rad()) {
    options.rotation_tolerance_rad = proto.rotation_tolerance_rad();
  }
  if (proto.has_max_step()) options.max_step = proto.max_step();
  options.limit_speed = proto.limit_speed();
  if (proto.has_time_limit()) {
    options.time_limit = FromProto(proto.time_limit());
  }
  if (proto.diagnose()) options.detail = ReportDetail::kDiagnosis;

  Violations violations;
  if (const auto method = FromProto(proto.method())) {
    options.method = *method;
  } else {
    violations.Add("method", absl::StrCat("no such solver method: ",
                                          static_cast<int>(proto.method())));
  }
  violations.AddStatus("", CheckSolverOptions(options));
  if (!violations.empty()) return violations.ToStatus();
  return options;
}

void ToProto(const SolverOptions& options, v1::SolverOptions* proto) {
  proto->set_method(ToProto(options.method));
  proto->set_max_iterations(options.max_iterations);
  if (options.max_restarts) proto->set_max_restarts(*options.max_restarts);
  proto->set_restart_seed(options.restart_seed);
  proto->set_position_tolerance_m(options.position_tolerance_m);
  proto->set_rotation_tolerance_rad(options.rotation_tolerance_rad);
  if (options.max_step) proto->set_max_step(*options.max_step);
  proto->set_limit_speed(options.limit_speed);
  if (options.time_limit) {
    ToProto(*options.time_limit, proto->mutable_time_limit());
  }
  proto->set_diagnose(options.detail == ReportDetail::kDiagnosis);
}

void ToProto(const SolveReport& report, ReportDetail detail,
             absl::Duration solve_duration, v1::SolveReport* proto) {
  proto->Clear();
  proto->set_outcome(OutcomeToProto(report.outcome));
  proto->set_iteration_count(report.iteration_count);
  proto->set_restart_count(report.restart_count);
  CopyErrors(report.position_errors_m, proto->mutable_position_errors_m());
  CopyErrors(report.rotation_errors_rad, proto->mutable_rotation_errors_rad());
  ToProto(solve_duration, proto->mutable_solve_duration());
  if (detail == ReportDetail::kBrief) return;
  proto->set_method(ToProto(report.method));
  proto->set_kkt_residual(report.kkt_residual);
  for (int joint : report.limited_joints) proto->add_limited_joints(joint);
  proto->set_change(report.change);
  if (detail != ReportDetail::kDiagnosis) return;
  proto->set_rank(report.rank);
  proto->set_free_velocity_count(report.free_velocity_count);
  proto->set_translation_manipulability(report.translation_manipulability);
  proto->set_rotation_manipulability(report.rotation_manipulability);
}

}  // namespace gelenk::convert
