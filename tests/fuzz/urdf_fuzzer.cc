// Any bytes are refused with a decent error, or make a skeleton in which every
// joint and link of the file is found.

#include <cstdint>

#include "gelenk/import/urdf_import.h"
#include "gelenk/import/urdf_reader.h"
#include "tests/fuzz/imported_skeleton.h"

namespace gelenk {
namespace {

// Small, so that a fuzzer makes many runs a second.
constexpr UrdfBounds kBounds = {.max_bytes = 1 << 20,
                                .max_elements = 4096,
                                .max_attributes = 4096,
                                .max_joints = 64};
constexpr SkeletonBounds kSkeletonBounds = {
    .max_joints = 64, .max_depth = 32, .max_end_effectors = 64};

// Twenty lines and what comes before them.
constexpr size_t kMaxMessageBytes = 8192;

void Run(absl::string_view bytes) {
  const absl::StatusOr<UrdfDocument> document = ReadUrdf(bytes, kBounds);
  if (!document.ok()) {
    CheckRefusal(document.status(), kMaxMessageBytes);
    return;
  }
  const absl::StatusOr<UrdfImport> import =
      ImportUrdf(*document, kSkeletonBounds);
  if (!import.ok()) {
    CheckRefusal(import.status(), kMaxMessageBytes);
    return;
  }
  const Skeleton& skeleton = *import->skeleton;
  GELENK_FUZZ_CHECK(skeleton.joint_count() ==
                    static_cast<int>(document->joints.size()) + 1);
  GELENK_FUZZ_CHECK(document->links.size() == document->joints.size() + 1);
  CheckImported(skeleton);
}

}  // namespace
}  // namespace gelenk

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  gelenk::Run({reinterpret_cast<const char*>(data), size});
  return 0;
}
