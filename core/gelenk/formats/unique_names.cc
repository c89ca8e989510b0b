#include "gelenk/formats/unique_names.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace gelenk {
namespace {

bool IsContinuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
}

// Bytes of the well-formed UTF-8 character at the start of `text`, which is
// not empty; 0 when there is none (Unicode 15, table 3-7).
size_t Utf8Length(absl::string_view text) {
  const auto byte = [&text](size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  const size_t length = lead >= 0xC2 && lead <= 0xDF   ? 2
                        : lead >= 0xE0 && lead <= 0xEF ? 3
                        : lead >= 0xF0 && lead <= 0xF4 ? 4
                                                       : 0;
  // Overlong forms, surrogates and what lies beyond U+10FFFF show in the
  // second byte.
  const unsigned low = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  const unsigned high = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  if (length == 0 || byte(1) < low || byte(1) > high) return 0;
  for (size_t i = 2; i < length; ++i) {
    if (i >= text.size() || !IsContinuation(text[i])) return 0;
  }
  return length;
}

}  // namespace

absl::string_view TruncateUtf8(absl::string_view text, size_t max_bytes) {
  if (text.size() <= max_bytes) return text;
  size_t end = max_bytes;
  while (end > 0 && IsContinuation(text[end])) --end;
  return text.substr(0, end);
}

std::string PrintableUtf8(absl::string_view text) {
  constexpr absl::string_view kReplacement = "\xEF\xBF\xBD";
  std::string printable;
  while (!text.empty()) {
    const size_t length = Utf8Length(text);
    if (length == 0 || absl::ascii_iscntrl(text[0])) {
      absl::StrAppend(&printable, kReplacement);
      text.remove_prefix(1);
      continue;
    }
    absl::StrAppend(&printable, text.substr(0, length));
    text.remove_prefix(length);
  }
  return printable;
}

std::string UniqueNames::Take(absl::string_view name) {
  std::string base(TruncateUtf8(name, max_bytes_));
  if (taken_.insert(base).second) return base;
  int& number = next_number_.emplace(base, 2).first->second;
  while (true) {
    const std::string suffix = absl::StrCat("#", number++);
    std::string numbered =
        absl::StrCat(TruncateUtf8(base, max_bytes_ - suffix.size()), suffix);
    if (taken_.insert(numbered).second) return numbered;
  }
}

}  // namespace gelenk
