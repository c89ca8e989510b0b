#include "server/store/clip_name.h"

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "server/session/resource_name.h"

namespace gelenk::server {

absl::StatusOr<ClipName> ParseClipName(absl::string_view field,
                                       absl::string_view name) {
  const size_t at = name.find('@');
  const absl::string_view clip = name.substr(0, at);
  if (absl::Status status = CheckResourceName(field, kClips, clip);
      !status.ok()) {
    return status;
  }
  ClipName parsed = {std::string(clip)};
  if (at == absl::string_view::npos) return parsed;
  int revision = 0;
  if (!absl::SimpleAtoi(name.substr(at + 1), &revision) || revision < 1) {
    Violations violations;
    violations.Add(field, absl::StrCat("want clips/{id}@{revision}, counted "
                                       "from 1, after ",
                                       clip));
    return violations.ToStatus();
  }
  parsed.revision = revision;
  return parsed;
}

std::string RevisionName(absl::string_view name, int revision) {
  return absl::StrCat(name, "@", revision);
}

}  // namespace gelenk::server
