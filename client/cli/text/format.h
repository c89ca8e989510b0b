// How results are printed: for people, or for programs.
#ifndef CLIENT_CLI_TEXT_FORMAT_H_
#define CLIENT_CLI_TEXT_FORMAT_H_

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

namespace gelenk::cli {

enum class Format { kTable, kJson };

// Keys in the order in which they were added.
using Json = nlohmann::ordered_json;

// Indented, ended by a line break; bytes that are no UTF-8 become U+FFFD.
std::string JsonText(const Json& json);

// With so many decimals; never "-0.00".
std::string Fixed(double value, int decimals);

// With so many digits that count.
std::string Significant(double value, int digits);

// How much `count` is of `total`: "99.95 %", or "100 %" when it is all; never
// rounded up to all, nor down to nothing. "-" of nothing.
std::string Percent(int64_t count, int64_t total);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_TEXT_FORMAT_H_
