#include "gelenk/import/gltf_json.h"

#include <algorithm>

#include "absl/status/status.h"
#include "absl/strings/str_format.h"
#include "gelenk/import/bounded_json.h"
#include "gelenk/import/glb_container.h"

namespace gelenk {

using nlohmann::json;

absl::StatusOr<json> ParseGltfJson(absl::string_view bytes,
                                   const GltfBounds& bounds,
                                   const GltfMembers& kept) {
  if (bytes.size() > bounds.max_bytes) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "want at most %d bytes, got %d", bounds.max_bytes, bytes.size()));
  }
  const absl::StatusOr<absl::string_view> text = JsonOfGltf(bytes);
  if (!text.ok()) return text.status();
  absl::StatusOr<json> root = ParseJson(
      *text,
      {bounds.max_json_bytes, bounds.max_json_depth, bounds.max_json_values},
      [&kept](int depth, absl::string_view key) {
        const auto& keys = depth == 1 ? kept.at_top : kept.below;
        return std::find(keys.begin(), keys.end(), key) != keys.end();
      });
  if (root.ok() && !root->is_object()) {
    return absl::InvalidArgumentError("want a JSON object: this is no glTF");
  }
  return root;
}

}  // namespace gelenk
