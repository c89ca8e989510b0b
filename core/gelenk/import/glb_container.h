// The outer shape of glTF files: JSON as it is, or in the first chunk of a GLB.
#ifndef GELENK_IMPORT_GLB_CONTAINER_H_
#define GELENK_IMPORT_GLB_CONTAINER_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace gelenk {

// The JSON text in `bytes`, a .gltf or .glb; a view of them. Errors:
// INVALID_ARGUMENT saying what is cut off or of another version.
absl::StatusOr<absl::string_view> JsonOfGltf(absl::string_view bytes);

// The second chunk of a .glb that JsonOfGltf takes, if it is whole and binary;
// else empty.
absl::string_view BinaryOfGltf(absl::string_view bytes);

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLB_CONTAINER_H_
