// Any bytes are refused with a decent error, or make a document that writes and
// reads back the same, and poses whose numbers are finite and come round.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "gelenk/formats/bvh_motion.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/formats/bvh_writer.h"
#include "gelenk/motion/body_parts.h"
#include "tests/fuzz/fuzz_check.h"

namespace gelenk {
namespace {

// Small, so that a fuzzer makes many runs a second.
constexpr BvhBounds kBounds = {.max_bytes = 1 << 20,
                               .max_joints = 64,
                               .max_end_sites = 64,
                               .max_depth = 32,
                               .max_frames = 10000,
                               .max_numbers = 1 << 16,
                               .max_name_bytes = 256};
constexpr size_t kMaxMessageBytes = 500;

bool SameNumbers(const Eigen::Ref<const Eigen::MatrixXd>& a,
                 const Eigen::Ref<const Eigen::MatrixXd>& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         (a.size() == 0 ||
          std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

void CheckWriting(const BvhDocument& document) {
  const absl::StatusOr<BvhDocument> again =
      ReadBvh(WriteBvh(document), kBounds);
  GELENK_FUZZ_CHECK(again.ok());
  GELENK_FUZZ_CHECK(SameNumbers(document.motion, again->motion));
  GELENK_FUZZ_CHECK(document.frame_time_s == again->frame_time_s);
  GELENK_FUZZ_CHECK(document.joints.size() == again->joints.size());
  for (size_t i = 0; i < document.joints.size(); ++i) {
    const BvhJoint& a = document.joints[i];
    const BvhJoint& b = again->joints[i];
    GELENK_FUZZ_CHECK(a.name == b.name && a.parent == b.parent);
    GELENK_FUZZ_CHECK(a.channels == b.channels);
    GELENK_FUZZ_CHECK(SameNumbers(a.offset, b.offset));
    GELENK_FUZZ_CHECK(a.end_sites.size() == b.end_sites.size());
  }
}

void CheckPoses(const BvhDocument& document) {
  const absl::StatusOr<BvhImport> import = ImportBvh(document);
  // Names are mended and sizes bounded, so nothing is left to refuse.
  GELENK_FUZZ_CHECK(import.ok());
  FindBodyParts(*import->skeleton);
  const absl::StatusOr<Eigen::MatrixXd> poses = PosesFromBvh(document, *import);
  GELENK_FUZZ_CHECK(poses.ok() && poses->allFinite());
  const absl::StatusOr<BvhDocument> back =
      BvhFromPoses(document, *import, *poses);
  GELENK_FUZZ_CHECK(back.ok() && back->motion.allFinite());
  const absl::StatusOr<Eigen::MatrixXd> again = PosesFromBvh(*back, *import);
  GELENK_FUZZ_CHECK(again.ok());
  if (poses->size() == 0) return;
  // Angles up to 1e9 degrees keep seven digits, and so does what they make.
  const double largest = std::max(1.0, document.motion.cwiseAbs().maxCoeff());
  const double tolerance = 1e-12 * largest;
  GELENK_FUZZ_CHECK((*poses - *again).cwiseAbs().maxCoeff() <= tolerance);
}

}  // namespace
}  // namespace gelenk

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const absl::string_view bytes(reinterpret_cast<const char*>(data), size);
  const absl::StatusOr<gelenk::BvhDocument> document =
      gelenk::ReadBvh(bytes, gelenk::kBounds);
  if (!document.ok()) {
    gelenk::CheckRefusal(document.status(), gelenk::kMaxMessageBytes);
    return 0;
  }
  gelenk::CheckWriting(*document);
  gelenk::CheckPoses(*document);
  return 0;
}
