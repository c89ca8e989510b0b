#include "gelenk/ik/solver_options.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/number_check.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

void CheckCount(absl::string_view field, int value, int most,
                Violations& violations) {
  if (value >= 0 && value <= most) return;
  violations.Add(field, absl::StrFormat("want 0 to %d, got %d", most, value));
}

}  // namespace

absl::Status CheckSolverOptions(const SolverOptions& options) {
  Violations violations;
  CheckCount("max_iterations", options.max_iterations, kMaxIterations,
             violations);
  CheckCount("max_restarts", options.max_restarts.value_or(0), kMaxRestarts,
             violations);
  const int64_t total = int64_t{options.max_iterations} *
                        (1 + options.max_restarts.value_or(kColdRestarts));
  if (violations.empty() && total > kMaxTotalIterations) {
    violations.Add("max_restarts",
                   absl::StrFormat("want at most %d iterations over all "
                                   "restarts, got %d",
                                   kMaxTotalIterations, total));
  }
  CheckPositive("position_tolerance_m", options.position_tolerance_m,
                violations);
  CheckPositive("rotation_tolerance_rad", options.rotation_tolerance_rad,
                violations);
  if (options.max_step) {
    CheckPositive("max_step", *options.max_step, violations);
  }
  if (options.time_limit && !(*options.time_limit > absl::ZeroDuration())) {
    violations.Add("time_limit",
                   absl::StrCat("want more than 0, got ",
                                absl::FormatDuration(*options.time_limit)));
  }
  return violations.ToStatus();
}

}  // namespace gelenk
