// Which files are read as glTF.
#ifndef CLIENT_CLI_GLTF_PATH_H_
#define CLIENT_CLI_GLTF_PATH_H_

#include "absl/strings/match.h"
#include "absl/strings/string_view.h"

namespace gelenk::cli {

// A VRM avatar is a GLB by another name.
inline bool IsGlbPath(absl::string_view path) {
  return absl::EndsWithIgnoreCase(path, ".glb") ||
         absl::EndsWithIgnoreCase(path, ".vrm");
}

inline bool IsGltfPath(absl::string_view path) {
  return absl::EndsWithIgnoreCase(path, ".gltf") || IsGlbPath(path);
}

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_GLTF_PATH_H_
