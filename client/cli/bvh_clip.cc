#include "client/cli/bvh_clip.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/file_bytes.h"
#include "gelenk/formats/bvh_motion.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/formats/bvh_writer.h"

namespace gelenk::cli {

absl::StatusOr<BvhClip> ReadBvhClip(const std::string& path,
                                    std::optional<double> unit_m) {
  const absl::StatusOr<std::string> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  BvhClip clip;
  absl::StatusOr<BvhDocument> document = ReadBvh(*bytes);
  if (!document.ok()) return InFile(path, document.status());
  clip.document = *std::move(document);
  absl::StatusOr<BvhImport> import = ImportBvh(clip.document, {unit_m});
  if (!import.ok()) return InFile(path, import.status());
  clip.import = *std::move(import);
  absl::StatusOr<Eigen::MatrixXd> poses =
      PosesFromBvh(clip.document, clip.import);
  if (!poses.ok()) return InFile(path, poses.status());
  clip.poses = *std::move(poses);
  return clip;
}

absl::Status WriteBvhClip(const BvhClip& clip, const Eigen::MatrixXd& poses,
                          const std::string& path) {
  const absl::StatusOr<BvhDocument> document =
      BvhFromPoses(clip.document, clip.import, poses);
  if (!document.ok()) return InFile(path, document.status());
  return WriteFile(path, WriteBvh(*document));
}

}  // namespace gelenk::cli
