// The length of a file's unit, as importers are told it.
#ifndef GELENK_FORMATS_FILE_UNIT_H_
#define GELENK_FORMATS_FILE_UNIT_H_

#include "absl/status/status.h"
#include "absl/strings/str_format.h"

namespace gelenk {

// A nanometre to a thousand kilometres; anything else is a mistake.
inline constexpr double kMinFileUnitM = 1e-9;
inline constexpr double kMaxFileUnitM = 1e6;

// INVALID_ARGUMENT that names `unit_m`.
inline absl::Status CheckFileUnit(double unit_m) {
  // NaN fails the comparison.
  if (unit_m >= kMinFileUnitM && unit_m <= kMaxFileUnitM) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrFormat(
      "unit_m: want %g to %g, got %g", kMinFileUnitM, kMaxFileUnitM, unit_m));
}

}  // namespace gelenk

#endif  // GELENK_FORMATS_FILE_UNIT_H_
