// Any bytes are refused with a decent error, or make a skin that deforms.

#include <cstdint>

#include "gelenk/import/gltf_import.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/import/gltf_skin.h"
#include "gelenk/skin/weighted_skin.h"
#include "tests/fuzz/fuzz_check.h"

namespace gelenk {
namespace {

// Small, so that a fuzzer makes many runs a second.
constexpr GltfBounds kBounds = {.max_bytes = 1 << 20,
                                .max_json_bytes = 1 << 19,
                                .max_json_depth = 16,
                                .max_json_values = 4096,
                                .max_nodes = 256};
constexpr MeshBounds kMeshBounds = {.max_vertices = 256, .max_triangles = 256};

// Twenty lines and what comes before them.
constexpr size_t kMaxMessageBytes = 8192;

void Run(absl::string_view bytes) {
  const absl::StatusOr<GltfDocument> document = ReadGltf(bytes, kBounds);
  if (!document.ok()) return;
  GltfImportOptions import_options;
  import_options.bounds = {
      .max_joints = 64, .max_depth = 32, .max_end_effectors = 16};
  const absl::StatusOr<GltfImport> import =
      ImportGltf(*document, import_options);
  if (!import.ok()) return;
  GltfSkinOptions options;
  options.bounds = kMeshBounds;
  const absl::StatusOr<GltfSkinnedMesh> read =
      ReadGltfSkin(bytes, *document, *import, options, nullptr, kBounds);
  if (!read.ok()) {
    CheckRefusal(read.status(), kMaxMessageBytes);
    return;
  }
  const auto skin = WeightedSkin::Create(import->skeleton, read->mesh,
                                         read->weights, BindOptions(*read));
  GELENK_FUZZ_CHECK(skin.ok());
  SkinWorkspace workspace;
  VertexBlocks blocks;
  (*skin)->Deform(import->skeleton->rest_positions(), {}, workspace, blocks);
  GELENK_FUZZ_CHECK((*skin)->vertex_count() ==
                    static_cast<int>(read->mesh.positions.size()));
  for (int slot : (*skin)->slots()) {
    GELENK_FUZZ_CHECK(blocks.position(slot).allFinite());
    GELENK_FUZZ_CHECK(blocks.normal(slot).allFinite());
  }
}

}  // namespace
}  // namespace gelenk

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  gelenk::Run({reinterpret_cast<const char*>(data), size});
  return 0;
}
