#include "client/cli/tolerance.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/text/number_list.h"

namespace gelenk::cli {

absl::StatusOr<Tolerance> ParseTolerance(absl::string_view text,
                                         const Tolerance& fallback) {
  const absl::StatusOr<std::vector<double>> numbers = ParseNumbers(text);
  if (!numbers.ok()) return numbers.status();
  if (numbers->size() > 2) {
    return absl::InvalidArgumentError(
        absl::StrCat("want metres, or metres and radians, got \"", text, "\""));
  }
  for (double number : *numbers) {
    if (number > 0) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("want numbers above 0, got ", number));
  }
  return Tolerance{numbers->front(), numbers->size() == 2
                                         ? numbers->back()
                                         : fallback.rotation_rad};
}

void SetTolerance(const Tolerance& tolerance, v1::SolverOptions* options) {
  options->set_position_tolerance_m(tolerance.position_m);
  options->set_rotation_tolerance_rad(tolerance.rotation_rad);
}

}  // namespace gelenk::cli
