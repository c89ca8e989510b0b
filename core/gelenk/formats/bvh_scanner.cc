#include "gelenk/formats/bvh_scanner.h"

#include <cmath>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "gelenk/formats/decimal_number.h"

namespace gelenk {
namespace {

// As much of a token as an error repeats.
constexpr size_t kMaxQuotedBytes = 40;

bool IsBlank(char c) {
  return c == ' ' || (static_cast<unsigned char>(c - '\t') <= '\r' - '\t');
}

bool EndsLine(char c) { return c == '\n' || c == '\r'; }

bool IsBrace(char c) { return c == '{' || c == '}'; }

}  // namespace

bool BvhScanner::SkipBlanks() {
  bool line_ended = false;
  while (at_ < text_.size() && IsBlank(text_[at_])) {
    line_ended |= EndsLine(text_[at_]);
    ++at_;
  }
  return line_ended;
}

absl::string_view BvhScanner::Peek() {
  SkipBlanks();
  size_t end = at_;
  if (end < text_.size() && IsBrace(text_[end])) return text_.substr(at_, 1);
  while (end < text_.size() && !IsBlank(text_[end]) && !IsBrace(text_[end])) {
    ++end;
  }
  return text_.substr(at_, end - at_);
}

absl::string_view BvhScanner::Take() {
  const absl::string_view token = Peek();
  at_ += token.size();
  return token;
}

bool BvhScanner::TakeKeyword(absl::string_view keyword) {
  if (!absl::EqualsIgnoreCase(Peek(), keyword)) return false;
  Take();
  return true;
}

bool BvhScanner::TakeWord(absl::string_view word) {
  const absl::string_view token = Peek();
  size_t letters = 0;
  while (letters < token.size() && absl::ascii_isalpha(token[letters])) {
    ++letters;
  }
  if (!absl::EqualsIgnoreCase(token.substr(0, letters), word)) return false;
  at_ += letters;
  return true;
}

bool BvhScanner::TakeColon() {
  if (!absl::StartsWith(Peek(), ":")) return false;
  ++at_;
  return true;
}

absl::string_view BvhScanner::TakeName() {
  SkipBlanks();
  size_t end = at_;
  while (end < text_.size() && !EndsLine(text_[end]) && text_[end] != '{') {
    ++end;
  }
  const absl::string_view name = text_.substr(at_, end - at_);
  at_ = end;
  return absl::StripAsciiWhitespace(name);
}

absl::StatusOr<double> BvhScanner::TakeNumber() {
  const absl::string_view token = Peek();
  double number = 0;
  std::errc error{};
  if (!ParseDecimal(token, number, error)) return Expected("a number");
  if (error != std::errc{} || !(std::abs(number) <= kMaxMagnitude)) {
    return Expected("a finite number of at most 1e9");
  }
  at_ += token.size();
  return number;
}

absl::StatusOr<int64_t> BvhScanner::TakeCount() {
  const absl::string_view token = Peek();
  int64_t count = 0;
  std::errc error{};
  if (!ParseDecimal(token, count, error) || error != std::errc{} || count < 0) {
    return Expected("a whole number >= 0");
  }
  at_ += token.size();
  return count;
}

std::string BvhScanner::Position() {
  SkipBlanks();
  for (; counted_ < at_; ++counted_) {
    if (!EndsLine(text_[counted_])) continue;
    const size_t next = counted_ + 1;
    // CR LF ends one line, not two.
    if (text_[counted_] == '\r' && next < text_.size() && text_[next] == '\n') {
      continue;
    }
    ++line_;
    line_start_ = next;
  }
  return absl::StrCat("line ", line_, ", column ", at_ - line_start_ + 1);
}

absl::Status BvhScanner::Expected(absl::string_view what) {
  absl::string_view token = Peek();
  std::string got = "end of file";
  if (!token.empty()) {
    const absl::string_view quoted = token.substr(0, kMaxQuotedBytes);
    got = absl::StrCat("\"", absl::CHexEscape(quoted),
                       quoted.size() < token.size() ? "..." : "", "\"");
  }
  return absl::InvalidArgumentError(
      absl::StrCat(Position(), ": expected ", what, ", got ", got));
}

}  // namespace gelenk
