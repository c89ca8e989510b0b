// When goals count as reached.
#ifndef CLIENT_CLI_TOLERANCE_H_
#define CLIENT_CLI_TOLERANCE_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/v1/ik.pb.h"

namespace gelenk::cli {

struct Tolerance {
  double position_m = 1e-4;
  double rotation_rad = 1e-3;
};

// "1e-3" or "1e-3,1e-2": metres, and radians, else those of `fallback`.
// INVALID_ARGUMENT unless they are above 0.
absl::StatusOr<Tolerance> ParseTolerance(absl::string_view text,
                                         const Tolerance& fallback);

void SetTolerance(const Tolerance& tolerance, v1::SolverOptions* options);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_TOLERANCE_H_
