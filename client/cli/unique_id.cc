#include "client/cli/unique_id.h"

#include <random>

#include "absl/strings/str_format.h"

namespace gelenk::cli {

std::string UniqueId() {
  std::random_device random;
  return absl::StrFormat("cli-%08x%08x", random(), random());
}

}  // namespace gelenk::cli
