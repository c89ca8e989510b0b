// JSON that is no larger and no deeper than its reader wants.
#ifndef GELENK_IMPORT_BOUNDED_JSON_H_
#define GELENK_IMPORT_BOUNDED_JSON_H_

#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace gelenk {

struct JsonBounds {
  size_t max_bytes;
  // Of arrays and objects inside each other.
  size_t max_depth;
  // Kept or not.
  size_t max_values;
};

// Says whether the member `key` of an object is kept; objects at the top of the
// text have depth 1. What is not kept is read, and takes no memory.
using KeepMember = std::function<bool(int depth, absl::string_view key)>;

// Errors: INVALID_ARGUMENT with line and column, or with the bound: reading
// ends where it is passed.
absl::StatusOr<nlohmann::json> ParseJson(absl::string_view text,
                                         const JsonBounds& bounds,
                                         const KeepMember& keep);

}  // namespace gelenk

#endif  // GELENK_IMPORT_BOUNDED_JSON_H_
