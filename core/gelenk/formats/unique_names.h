// Keeps names apart by numbering those that come again: arm, arm#2, arm#3.
#ifndef GELENK_FORMATS_UNIQUE_NAMES_H_
#define GELENK_FORMATS_UNIQUE_NAMES_H_

#include <string>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/strings/string_view.h"

namespace gelenk {

// Cuts `text` to at most `max_bytes`, never inside a UTF-8 character.
absl::string_view TruncateUtf8(absl::string_view text, size_t max_bytes);

// `text` with control characters and bytes that are not UTF-8 replaced by
// U+FFFD.
std::string PrintableUtf8(absl::string_view text);

class UniqueNames {
 public:
  // Names longer than `max_bytes` are cut, so that the number fits as well.
  explicit UniqueNames(size_t max_bytes) : max_bytes_(max_bytes) {}

  bool Contains(absl::string_view name) const { return taken_.contains(name); }

  // `name`, or the first of name#2, name#3 ... that is free; it is then taken.
  std::string Take(absl::string_view name);

 private:
  size_t max_bytes_;
  absl::flat_hash_set<std::string> taken_;
  // The number to try next, so that equal names cost linear time.
  absl::flat_hash_map<std::string, int> next_number_;
};

}  // namespace gelenk

#endif  // GELENK_FORMATS_UNIQUE_NAMES_H_
