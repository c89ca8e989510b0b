#include "client/cli/text/number_list.h"

#include <cmath>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"

namespace gelenk::cli {

absl::StatusOr<double> ParseNumber(absl::string_view text) {
  double number = 0;
  if (absl::SimpleAtod(text, &number) && std::isfinite(number)) return number;
  return absl::InvalidArgumentError(
      absl::StrCat("want a number, got \"", text, "\""));
}

absl::StatusOr<std::vector<double>> ParseNumbers(absl::string_view text) {
  std::vector<double> numbers;
  // An empty piece between two commas is a number left out, not white space.
  for (absl::string_view group : absl::StrSplit(text, ',')) {
    const std::vector<absl::string_view> pieces =
        absl::StrSplit(group, absl::ByAnyChar(" \t\r\n"), absl::SkipEmpty());
    if (pieces.empty()) {
      return absl::InvalidArgumentError(
          absl::StrCat("want numbers separated by commas, got \"", text, "\""));
    }
    for (absl::string_view piece : pieces) {
      const absl::StatusOr<double> number = ParseNumber(piece);
      if (!number.ok()) return number.status();
      numbers.push_back(*number);
    }
  }
  return numbers;
}

absl::StatusOr<std::vector<double>> ParseNumbers(absl::string_view text,
                                                 int count) {
  absl::StatusOr<std::vector<double>> numbers = ParseNumbers(text);
  if (numbers.ok() && numbers->size() != static_cast<size_t>(count)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "want %d numbers, got %d in \"%s\"", count, numbers->size(), text));
  }
  return numbers;
}

}  // namespace gelenk::cli
