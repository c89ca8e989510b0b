// Collects everything that is wrong with an input, so that a caller can mend
// it in one go.
#ifndef GELENK_BASE_VIOLATIONS_H_
#define GELENK_BASE_VIOLATIONS_H_

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace gelenk {

// One thing that is wrong: `field` is a path ("joints[3].limits.lower[0]"),
// `description` says what and names the value.
struct Violation {
  std::string field;
  std::string description;
};

// Keeps the first twenty and counts the rest: a malformed megabyte must become
// neither a megabyte of message nor of memory. Cost: nothing is allocated while
// nothing is wrong.
class Violations {
 public:
  void Add(absl::string_view field, absl::string_view description);

  // Adds the violations of `status` (or its message) below `field`.
  void AddStatus(absl::string_view field, const absl::Status& status);

  bool empty() const { return list_.empty(); }

  // OK when empty; else INVALID_ARGUMENT whose message lists those kept, and
  // whose payload carries them for FromStatus.
  absl::Status ToStatus() const;

  // The violations that ToStatus packed into `status`; empty when it has none.
  static std::vector<Violation> FromStatus(const absl::Status& status);

 private:
  std::vector<Violation> list_;
  size_t dropped_ = 0;
};

}  // namespace gelenk

#endif  // GELENK_BASE_VIOLATIONS_H_
