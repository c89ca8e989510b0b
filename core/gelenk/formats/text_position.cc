#include "gelenk/formats/text_position.h"

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace gelenk {
namespace {

// As much of a token as an error repeats.
constexpr size_t kMaxQuotedBytes = 40;

}  // namespace

std::string TextPosition::Of(size_t at) {
  for (; counted_ < at; ++counted_) {
    const char c = text_[counted_];
    if (c != '\n' && c != '\r') continue;
    const size_t next = counted_ + 1;
    // CR LF ends one line, not two.
    if (c == '\r' && next < text_.size() && text_[next] == '\n') continue;
    ++line_;
    line_start_ = next;
  }
  return absl::StrCat("line ", line_, ", column ", at - line_start_ + 1);
}

absl::Status TextPosition::Expected(size_t at, absl::string_view what,
                                    absl::string_view token,
                                    absl::string_view no_token) {
  std::string got(no_token);
  if (!token.empty()) {
    const absl::string_view quoted = token.substr(0, kMaxQuotedBytes);
    got = absl::StrCat("\"", absl::CHexEscape(quoted),
                       quoted.size() < token.size() ? "..." : "", "\"");
  }
  return absl::InvalidArgumentError(
      absl::StrCat(Of(at), ": expected ", what, ", got ", got));
}

}  // namespace gelenk
