#include "client/cli/text/format.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace gelenk::cli {

std::string JsonText(const Json& json) {
  return absl::StrCat(json.dump(2, ' ', false, Json::error_handler_t::replace),
                      "\n");
}

std::string Fixed(double value, int decimals) {
  const bool vanishes = std::abs(value) < 0.5 * std::pow(10.0, -decimals);
  return absl::StrFormat("%.*f", decimals, vanishes ? 0.0 : value);
}

std::string Significant(double value, int digits) {
  return absl::StrFormat("%.*g", digits, value);
}

std::string Percent(int64_t count, int64_t total) {
  if (total == 0) return "-";
  if (count == 0 || count == total) return count == 0 ? "0 %" : "100 %";
  const double percent =
      100 * static_cast<double>(count) / static_cast<double>(total);
  return absl::StrCat(Fixed(std::clamp(percent, 0.01, 99.99), 2), " %");
}

}  // namespace gelenk::cli
