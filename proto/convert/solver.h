// Solver options and reports between the contract and the core.
#ifndef GELENK_CONVERT_SOLVER_H_
#define GELENK_CONVERT_SOLVER_H_

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "gelenk/ik/solve_report.h"
#include "gelenk/ik/solver_options.h"
#include "gelenk/v1/ik.pb.h"

namespace gelenk::convert {

// INVALID_ARGUMENT listing every field out of range.
absl::StatusOr<SolverOptions> FromProto(const v1::SolverOptions& proto);
void ToProto(const SolverOptions& options, v1::SolverOptions* proto);

v1::SolveReport::Outcome OutcomeToProto(SolveOutcome outcome);

// `detail` says which parts of the report are filled in. Allocates nothing once
// `proto` has held a report of that size.
void ToProto(const SolveReport& report, ReportDetail detail,
             absl::Duration solve_duration, v1::SolveReport* proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_SOLVER_H_
