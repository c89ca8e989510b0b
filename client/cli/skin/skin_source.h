// What `gelenk skin` is told to bind: a bundled shape, or files.
#ifndef CLIENT_CLI_SKIN_SKIN_SOURCE_H_
#define CLIENT_CLI_SKIN_SKIN_SOURCE_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/v1/skeleton.pb.h"
#include "gelenk/v1/skin.pb.h"

namespace gelenk::cli {

enum class SkinMethod { kLayered, kLinear, kDualQuaternion };

struct SkinSourceOptions {
  // "arm", "leg", "humanoid", "cylinder", or a .glb, .gltf, .obj or .json file.
  std::string path;
  // Of an OBJ or JSON file: where its skeleton is. A glTF file has its own.
  std::string skeleton_path;
  // Of a shape; 0 means the service's default.
  std::optional<int> vertex_count;
  // Of a glTF or OBJ file, m.
  std::optional<double> unit_m;
  // Of a glTF file: names of its skin, and of its mesh.
  std::optional<std::string> skin;
  std::optional<std::string> mesh;
  // Weights come from a glTF file only.
  SkinMethod method = SkinMethod::kLayered;
};

struct SkinSource {
  // Without the name of a skeleton.
  v1::Skin skin;
  // Unset for a shape, which brings its own.
  std::optional<v1::Skeleton> skeleton;
  std::vector<std::string> warnings;
};

// INVALID_ARGUMENT naming an option that says nothing of such a source;
// `path` may also be skins/NAME, of which none does.
absl::Status CheckSourceOptions(const SkinSourceOptions& options);

// Errors name the file and the place in it.
absl::StatusOr<SkinSource> ReadSkinSource(const SkinSourceOptions& options);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_SKIN_SOURCE_H_
