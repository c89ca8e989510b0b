#include "server/session/revision_name.h"

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "server/session/resource_name.h"

namespace gelenk::server {

absl::StatusOr<RevisionedName> ParseRevisionName(absl::string_view field,
                                                 absl::string_view collection,
                                                 absl::string_view text) {
  const size_t at = text.find('@');
  RevisionedName result{std::string(text.substr(0, at)), std::nullopt};
  absl::Status status = CheckResourceName(field, collection, result.name);
  if (!status.ok()) return status;
  if (at == absl::string_view::npos) return result;
  const absl::string_view digits = text.substr(at + 1);
  int64_t revision = 0;
  // Written in one way only: names are compared as text.
  if (!absl::SimpleAtoi(digits, &revision) || revision < 1 ||
      absl::StrCat(revision) != digits) {
    Violations violations;
    violations.Add(field, absl::StrCat("want ", result.name,
                                       "@{revision}, a number above 0"));
    return violations.ToStatus();
  }
  result.revision = revision;
  return result;
}

std::string RevisionText(absl::string_view name, int64_t revision) {
  return absl::StrCat(name, "@", revision);
}

}  // namespace gelenk::server
