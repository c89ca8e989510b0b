#include "client/cli/motion/clip_writer.h"

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cli/file_bytes.h"
#include "gelenk/formats/bvh_clip.h"
#include "gelenk/formats/bvh_writer.h"
#include "gelenk/import/gltf_writer.h"
#include "gelenk/motion/clip_frames.h"

namespace gelenk::cli {
namespace {

absl::StatusOr<std::string> TextOf(const BodyFile& body, const MotionClip& clip,
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
      body.clip ? BvhFromClip(body.clip->document, body.clip->import, clip)
                : BvhFromClip(clip);
  if (!document.ok()) return document.status();
  return WriteBvh(*document);
}

}  // namespace

absl::Status WriteClip(const BodyFile& body, const Eigen::MatrixXd& positions,
                       double frame_time_s, const std::string& path) {
  ClipProperties properties;
  properties.name = body.name;
  properties.frame_time_s = frame_time_s;
  const absl::StatusOr<MotionClip> clip =
      ClipFromFrames(body.model->skeleton, positions, properties);
  if (!clip.ok()) return InFile(path, clip.status());
  const absl::StatusOr<std::string> text = TextOf(body, *clip, path);
  if (!text.ok()) return InFile(path, text.status());
  return WriteFile(path, *text);
}

}  // namespace gelenk::cli
