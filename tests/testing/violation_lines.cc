#include "tests/testing/violation_lines.h"

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"

namespace gelenk::testing {

std::vector<std::string> ViolationLines(const absl::Status& status) {
  std::vector<std::string> lines;
  for (const Violation& violation : Violations::FromStatus(status)) {
    lines.push_back(absl::StrCat(violation.field, ": ", violation.description));
  }
  return lines;
}

}  // namespace gelenk::testing
