// Names of clips: "clips/{id}" is the newest revision, "clips/{id}@{revision}"
// a certain one.
#ifndef GELENK_SERVER_STORE_CLIP_NAME_H_
#define GELENK_SERVER_STORE_CLIP_NAME_H_

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace gelenk::server {

inline constexpr absl::string_view kClips = "clips";

struct ClipName {
  // Without revision.
  std::string name;
  std::optional<int> revision = std::nullopt;
};

// INVALID_ARGUMENT naming `field`.
absl::StatusOr<ClipName> ParseClipName(absl::string_view field,
                                       absl::string_view name);

std::string RevisionName(absl::string_view name, int revision);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_STORE_CLIP_NAME_H_
