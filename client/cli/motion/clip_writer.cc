#include "client/cli/motion/clip_writer.h"

#include "absl/status/statusor.h"
#include "absl/strings/match.h"
#include "client/cli/file_bytes.h"
#include "gelenk/formats/bvh_clip.h"
#include "gelenk/formats/bvh_writer.h"
#include "gelenk/import/gltf_writer.h"

namespace gelenk::cli {
namespace {

absl::StatusOr<std::string> TextOf(const MotionClip& clip, const BvhClip* form,
                                   const std::string& path) {
  if (absl::EndsWithIgnoreCase(path, ".gltf")) {
    return WriteGltf(clip, GltfForm::kJson);
  }
  if (absl::EndsWithIgnoreCase(path, ".glb")) {
    return WriteGltf(clip, GltfForm::kBinary);
  }
  if (!absl::EndsWithIgnoreCase(path, ".bvh")) {
    return absl::InvalidArgumentError("want a .bvh, .gltf or .glb file");
  }
  const absl::StatusOr<BvhDocument> document =
      form != nullptr ? BvhFromClip(form->document, form->import, clip)
                      : BvhFromClip(clip);
  if (!document.ok()) return document.status();
  return WriteBvh(*document);
}

}  // namespace

absl::Status WriteClip(const MotionClip& clip, const BvhClip* form,
                       const std::string& path) {
  const absl::StatusOr<std::string> text = TextOf(clip, form, path);
  if (!text.ok()) return InFile(path, text.status());
  return WriteFile(path, *text);
}

}  // namespace gelenk::cli
