#include "server/rpc/clip_import.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/formats/bvh_clip.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/import/gltf_animation.h"
#include "gelenk/import/gltf_clip.h"
#include "gelenk/import/gltf_import.h"
#include "gelenk/import/gltf_reader.h"

namespace gelenk::server {
namespace {

absl::Status Malformed(absl::string_view field, absl::string_view description) {
  Violations violations;
  violations.Add(field, description);
  return violations.ToStatus();
}

absl::StatusOr<ClipImport> ImportBvhClip(const v1::ClipFile& file,
                                         const Limits& limits) {
  BvhBounds bounds;
  bounds.max_joints = limits.max_joints;
  bounds.max_numbers = limits.max_clip_numbers;
  absl::StatusOr<BvhDocument> document = ReadBvh(file.data(), bounds);
  if (!document.ok()) return document.status();
  BvhImportOptions options;
  if (file.has_unit_m()) options.unit_m = file.unit_m();
  absl::StatusOr<BvhImport> import = ImportBvh(*document, options);
  if (!import.ok()) return import.status();
  absl::StatusOr<MotionClip> clip = ClipFromBvh(*document, *import);
  if (!clip.ok()) return clip.status();
  // The rest of the motion is the clip.
  document->motion = Eigen::MatrixXd(document->motion.leftCols(1));
  std::vector<std::string> warnings = import->warnings;
  const double unit_m = import->unit_m;
  return ClipImport{*std::move(clip),
                    std::make_shared<const BvhForm>(
                        BvhForm{*std::move(document), *std::move(import)}),
                    unit_m, std::move(warnings)};
}

absl::StatusOr<ClipImport> ImportGltfClip(const v1::ClipFile& file,
                                          const Limits& limits) {
  GltfBounds bounds;
  bounds.max_animation_numbers = static_cast<size_t>(limits.max_clip_numbers);
  const absl::StatusOr<GltfDocument> document = ReadGltf(file.data(), bounds);
  if (!document.ok()) return document.status();
  GltfImportOptions options;
  options.bounds.max_joints = limits.max_joints;
  if (file.has_unit_m()) options.unit_m = file.unit_m();
  if (!file.skin().empty()) options.skin = file.skin();
  absl::StatusOr<GltfImport> import = ImportGltf(*document, options);
  if (!import.ok()) return import.status();
  const absl::StatusOr<std::vector<GltfAnimation>> animations =
      ReadGltfAnimations(file.data(), *document, nullptr, bounds);
  if (!animations.ok()) return animations.status();
  const int count = static_cast<int>(animations->size());
  const int index = file.animation_index();
  if (index < 0 || index >= count) {
    return Malformed(
        "file.animation_index",
        count == 0 ? "the file has no animation"
                   : absl::StrCat("want 0 to ", count - 1, ", got ", index));
  }
  absl::StatusOr<GltfClip> clip =
      ClipFromGltf((*animations)[index], *document, *import);
  if (!clip.ok()) return clip.status();
  std::vector<std::string> warnings = std::move(import->warnings);
  warnings.insert(warnings.end(), clip->warnings.begin(), clip->warnings.end());
  return ClipImport{std::move(clip->clip), nullptr, options.unit_m,
                    std::move(warnings)};
}

}  // namespace

absl::StatusOr<ClipImport> ImportClip(const v1::ClipFile& file,
                                      const Limits& limits) {
  switch (file.format()) {
    case v1::CLIP_FORMAT_BVH:
      return ImportBvhClip(file, limits);
    case v1::CLIP_FORMAT_GLTF:
    case v1::CLIP_FORMAT_GLB:
      return ImportGltfClip(file, limits);
    default:
      return Malformed(
          "file.format",
          absl::StrCat("no such format: ", static_cast<int>(file.format())));
  }
}

}  // namespace gelenk::server
