// Numbers as people type them: 1,0.5,-2e-3
#ifndef CLIENT_CLI_TEXT_NUMBER_LIST_H_
#define CLIENT_CLI_TEXT_NUMBER_LIST_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace gelenk::cli {

// One finite number. INVALID_ARGUMENT naming the text.
absl::StatusOr<double> ParseNumber(absl::string_view text);

// Numbers separated by commas or white space.
absl::StatusOr<std::vector<double>> ParseNumbers(absl::string_view text);

// Exactly `count` of them.
absl::StatusOr<std::vector<double>> ParseNumbers(absl::string_view text,
                                                 int count);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_TEXT_NUMBER_LIST_H_
