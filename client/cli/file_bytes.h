// Whole files in and out.
#ifndef CLIENT_CLI_FILE_BYTES_H_
#define CLIENT_CLI_FILE_BYTES_H_

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace gelenk::cli {

// Errors name the file: NOT_FOUND, PERMISSION_DENIED, FAILED_PRECONDITION for a
// directory.
absl::StatusOr<std::string> ReadFile(const std::string& path);

// Replaces what was there.
absl::Status WriteFile(const std::string& path, absl::string_view bytes);

// The same error, naming the file it is about.
absl::Status InFile(const std::string& path, const absl::Status& status);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_FILE_BYTES_H_
