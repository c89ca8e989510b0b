// Any bytes are refused with a decent error, or make a mesh that holds
// together.

#include <cstdint>

#include "gelenk/formats/obj_reader.h"
#include "tests/fuzz/fuzz_check.h"

namespace gelenk {
namespace {

constexpr size_t kMaxMessageBytes = 8192;

void Run(absl::string_view bytes) {
  ObjOptions options;
  options.max_bytes = 1 << 18;
  options.bounds = {.max_vertices = 1024, .max_triangles = 1024};
  const absl::StatusOr<ObjMesh> read = ReadObj(bytes, options);
  if (!read.ok()) {
    CheckRefusal(read.status(), kMaxMessageBytes);
    return;
  }
  GELENK_FUZZ_CHECK(CheckMesh(read->mesh, options.bounds).ok());
  GELENK_FUZZ_CHECK(!read->mesh.triangles.empty());
  GELENK_FUZZ_CHECK(VertexNormals(read->mesh).size() ==
                    read->mesh.positions.size());
}

}  // namespace
}  // namespace gelenk

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  gelenk::Run({reinterpret_cast<const char*>(data), size});
  return 0;
}
