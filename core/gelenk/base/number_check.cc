#include "gelenk/base/number_check.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace gelenk {
namespace {

// `range` is "", " > 0" or " >= 0".
void AddWanted(absl::string_view field, absl::string_view range, double value,
               Violations& violations) {
  const bool large = std::isfinite(value) && !IsUsable(value);
  const std::string most =
      large ? absl::StrFormat(" of at most %g", kLargestNumber) : "";
  violations.Add(field, absl::StrCat("want a finite number", range, most,
                                     ", got ", value));
}

}  // namespace

void CheckNumber(absl::string_view field, double value,
                 Violations& violations) {
  if (IsUsable(value)) return;
  AddWanted(field, "", value, violations);
}

void CheckPositive(absl::string_view field, double value,
                   Violations& violations) {
  if (IsUsable(value) && value > 0) return;
  AddWanted(field, " > 0", value, violations);
}

void CheckNotNegative(absl::string_view field, double value,
                      Violations& violations) {
  if (IsUsable(value) && value >= 0) return;
  AddWanted(field, " >= 0", value, violations);
}

void CheckNumbers(absl::string_view field,
                  const Eigen::Ref<const Eigen::VectorXd>& values,
                  Violations& violations) {
  bool usable = true;
  for (double value : values) usable = usable && IsUsable(value);
  if (usable) return;
  const bool large = values.allFinite();
  violations.Add(
      field, absl::StrCat(
                 "want finite numbers",
                 large ? absl::StrFormat(" of at most %g", kLargestNumber) : "",
                 ", got (",
                 absl::StrJoin(values, ", ",
                               [](std::string* out, double value) {
                                 absl::StrAppendFormat(out, "%g", value);
                               }),
                 ")"));
}

}  // namespace gelenk
