// Numbers in text, as every format but its own dialect writes them.
#ifndef GELENK_FORMATS_DECIMAL_NUMBER_H_
#define GELENK_FORMATS_DECIMAL_NUMBER_H_

#include <charconv>
#include <system_error>

#include "absl/strings/string_view.h"

namespace gelenk {

// Reads all of `token`, exactly and whatever the locale; false when it is
// anything but one decimal number. A sign + is fine; hexadecimal is not. "inf"
// and "nan" are read. `error` is result_out_of_range, and `number` as it was,
// for a number that the type cannot hold.
template <typename Number>
bool ParseDecimal(absl::string_view token, Number& number, std::errc& error) {
  const char* begin = token.data();
  const char* end = begin + token.size();
  // from_chars takes no plus sign.
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') ++begin;
  const std::from_chars_result result = std::from_chars(begin, end, number);
  error = result.ec;
  return error != std::errc::invalid_argument && result.ptr == end;
}

}  // namespace gelenk

#endif  // GELENK_FORMATS_DECIMAL_NUMBER_H_
