#include "gelenk/formats/bvh_scanner.h"

#include <cmath>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "gelenk/formats/decimal_number.h"

namespace gelenk {
namespace {

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

void BvhScanner::SkipLine() {
  while (at_ < text_.size() && !EndsLine(text_[at_])) ++at_;
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
  return position_.Of(at_);
}

absl::Status BvhScanner::Expected(absl::string_view what) {
  const absl::string_view token = Peek();
  return position_.Expected(at_, what, token, "end of file");
}

}  // namespace gelenk
