// Any bytes are refused with a decent error, or make a skeleton that stands
// where its nodes are bound to it.

#include <cstdint>

#include "gelenk/import/gltf_import.h"
#include "gelenk/import/gltf_reader.h"
#include "tests/fuzz/imported_skeleton.h"

namespace gelenk {
namespace {

// Small, so that a fuzzer makes many runs a second.
constexpr GltfBounds kBounds = {.max_bytes = 1 << 20,
                                .max_json_bytes = 1 << 19,
                                .max_json_depth = 16,
                                .max_json_values = 4096,
                                .max_nodes = 256};

// Twenty lines and what comes before them.
constexpr size_t kMaxMessageBytes = 8192;

void Run(absl::string_view bytes) {
  const absl::StatusOr<GltfDocument> document = ReadGltf(bytes, kBounds);
  if (!document.ok()) {
    CheckRefusal(document.status(), kMaxMessageBytes);
    return;
  }
  GltfImportOptions options;
  options.bounds = {.max_joints = 64, .max_depth = 32, .max_end_effectors = 16};
  const absl::StatusOr<GltfImport> import = ImportGltf(*document, options);
  if (!import.ok()) {
    CheckRefusal(import.status(), kMaxMessageBytes);
    return;
  }
  const Skeleton& skeleton = *import->skeleton;
  CheckImported(skeleton);
  GELENK_FUZZ_CHECK(import->joint_of_node.size() == document->nodes.size());
  int bound = 0;
  for (size_t node = 0; node < document->nodes.size(); ++node) {
    const int joint = import->joint_of_node[node];
    GELENK_FUZZ_CHECK(joint < skeleton.joint_count());
    bound += joint >= 0;
  }
  // Each joint but for a root that was added.
  GELENK_FUZZ_CHECK(bound == skeleton.joint_count() ||
                    bound == skeleton.joint_count() - 1);
}

}  // namespace
}  // namespace gelenk

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  gelenk::Run({reinterpret_cast<const char*>(data), size});
  return 0;
}
