// The JSON of a glTF file, with the members that its reader wants.
#ifndef GELENK_IMPORT_GLTF_JSON_H_
#define GELENK_IMPORT_GLTF_JSON_H_

#include <nlohmann/json.hpp>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/import/gltf_reader.h"

namespace gelenk {

// Members of the object at the top of a file, and of all below it.
struct GltfMembers {
  absl::Span<const absl::string_view> at_top;
  absl::Span<const absl::string_view> below;
};

// `bytes` are JSON or a GLB. Errors: INVALID_ARGUMENT for what is malformed, no
// object, or passes `bounds`.
absl::StatusOr<nlohmann::json> ParseGltfJson(absl::string_view bytes,
                                             const GltfBounds& bounds,
                                             const GltfMembers& kept);

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_JSON_H_
