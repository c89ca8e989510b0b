// Names of revisions, of clips and skins: "clips/{id}" is the newest one,
// "clips/{id}@{revision}" a certain one, from 1.
#ifndef GELENK_SERVER_SESSION_REVISION_NAME_H_
#define GELENK_SERVER_SESSION_REVISION_NAME_H_

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace gelenk::server {

struct RevisionedName {
  // Without the revision.
  std::string name;
  // Unset means the newest.
  std::optional<int64_t> revision;
};

// INVALID_ARGUMENT naming `field` unless `text` is "{collection}/{some id}" or
// that with "@{number above 0}".
absl::StatusOr<RevisionedName> ParseRevisionName(absl::string_view field,
                                                 absl::string_view collection,
                                                 absl::string_view text);

std::string RevisionText(absl::string_view name, int64_t revision);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_REVISION_NAME_H_
