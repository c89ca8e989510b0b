#include "client/cli/bvh_clip.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/file_bytes.h"
#include "gelenk/formats/amc_reader.h"
#include "gelenk/formats/asf_bvh.h"
#include "gelenk/formats/asf_reader.h"
#include "gelenk/formats/bvh_motion.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/formats/bvh_writer.h"

namespace gelenk::cli {

namespace {

// A document with what it is imported as.
absl::StatusOr<BvhClip> Imported(const std::string& path, BvhDocument document,
                                 std::optional<double> unit_m) {
  BvhClip clip;
  clip.document = std::move(document);
  absl::StatusOr<BvhImport> import = ImportBvh(clip.document, {unit_m});
  if (!import.ok()) return InFile(path, import.status());
  clip.import = *std::move(import);
  absl::StatusOr<Eigen::MatrixXd> poses =
      PosesFromBvh(clip.document, clip.import);
  if (!poses.ok()) return InFile(path, poses.status());
  clip.poses = *std::move(poses);
  return clip;
}

}  // namespace

absl::StatusOr<BvhClip> ReadBvhClip(const std::string& path,
                                    std::optional<double> unit_m) {
  const absl::StatusOr<std::string> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  absl::StatusOr<BvhDocument> document = ReadBvh(*bytes);
  if (!document.ok()) return InFile(path, document.status());
  return Imported(path, *std::move(document), unit_m);
}

absl::StatusOr<BvhClip> ReadAsfClip(const std::string& asf_path,
                                    const std::string& amc_path,
                                    std::optional<double> unit_m) {
  const absl::StatusOr<std::string> asf = ReadFile(asf_path);
  if (!asf.ok()) return asf.status();
  const absl::StatusOr<AsfDocument> skeleton = ReadAsf(*asf);
  if (!skeleton.ok()) return InFile(asf_path, skeleton.status());
  absl::StatusOr<AmcMotion> motion = AmcMotion();
  if (!amc_path.empty()) {
    const absl::StatusOr<std::string> amc = ReadFile(amc_path);
    if (!amc.ok()) return amc.status();
    motion = ReadAmc(*amc, *skeleton);
    if (!motion.ok()) return InFile(amc_path, motion.status());
  }
  return Imported(amc_path.empty() ? asf_path : amc_path,
                  BvhFromAsf(*skeleton, *motion), unit_m);
}

absl::Status WriteBvhClip(const BvhClip& clip, const Eigen::MatrixXd& poses,
                          const std::string& path) {
  const absl::StatusOr<BvhDocument> document =
      BvhFromPoses(clip.document, clip.import, poses);
  if (!document.ok()) return InFile(path, document.status());
  return WriteFile(path, WriteBvh(*document));
}

}  // namespace gelenk::cli
