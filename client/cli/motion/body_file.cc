#include "client/cli/motion/body_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cli/file_bytes.h"
#include "client/cli/gltf_path.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/retarget/floating_base.h"
#include "gelenk/retarget/humanoid.h"

namespace gelenk::cli {
namespace {

// A skeleton, from a file or bundled, with the motion that came with it.
struct Source {
  std::shared_ptr<const Skeleton> skeleton;
  std::optional<BvhClip> clip = {};
  std::vector<std::pair<std::string, std::string>> joint_of_bone = {};
  Eigen::MatrixXd frames = {};
  double frame_time_s = 0;
  std::vector<std::string> warnings = {};
};

absl::StatusOr<Source> ReadSource(const std::string& path,
                                  std::optional<double> unit_m) {
  const std::vector<absl::string_view> bundled = BundledSkeletonNames();
  if (std::find(bundled.begin(), bundled.end(), path) != bundled.end()) {
    return Source{.skeleton = BundledSkeleton(path).value()};
  }
  absl::StatusOr<SkeletonFile> file = ReadSkeletonFile(path, unit_m);
  if (!file.ok()) return file.status();
  Source source{.skeleton = std::move(file->skeleton),
                .clip = std::move(file->clip),
                .joint_of_bone = std::move(file->joint_of_bone)};
  if (source.clip) {
    source.frames = source.clip->poses;
    source.frame_time_s = source.clip->document.frame_time_s;
  }
  if (absl::EndsWithIgnoreCase(path, ".urdf")) {
    auto floating = WithFloatingBase(source.skeleton);
    if (!floating.ok()) return InFile(path, floating.status());
    source.skeleton = *std::move(floating);
  }
  return source;
}

absl::StatusOr<Source> ReadAmc(const std::string& path,
                               const MotionFileOptions& options) {
  absl::StatusOr<BvhClip> clip = ReadAmcClip(path, options);
  if (!clip.ok()) return clip.status();
  Source source{.skeleton = clip->import.skeleton, .frames = clip->poses};
  source.frame_time_s = clip->document.frame_time_s;
  source.clip = *std::move(clip);
  return source;
}

absl::StatusOr<Source> ReadAnimation(const std::string& path,
                                     const MotionFileOptions& options) {
  absl::StatusOr<MotionFile> file = ReadMotionFile(path, options);
  if (!file.ok()) return file.status();
  Source source{.skeleton = file->clip.skeleton(),
                .joint_of_bone = std::move(file->joint_of_bone),
                .frame_time_s = FrameTimeOf(file->clip),
                .warnings = std::move(file->warnings)};
  absl::StatusOr<Eigen::MatrixXd> frames = FramesFromClip(file->clip);
  if (!frames.ok()) return InFile(path, frames.status());
  source.frames = *std::move(frames);
  return source;
}

// `overrides`, and what the file says of roles that they do not name.
std::vector<JointMapOverride> RolesOf(
    const Source& source, absl::Span<const JointMapOverride> overrides) {
  std::vector<JointMapOverride> roles(overrides.begin(), overrides.end());
  if (source.joint_of_bone.empty()) return roles;
  for (JointMapOverride& told : OverridesOfHumanoid(source.joint_of_bone)) {
    const bool is_named = std::any_of(
        overrides.begin(), overrides.end(),
        [&told](const auto& given) { return given.role == told.role; });
    if (!is_named) roles.push_back(std::move(told));
  }
  return roles;
}

absl::StatusOr<std::vector<JointMapOverride>> EntriesFrom(
    const nlohmann::json& json, const char* key) {
  std::vector<JointMapOverride> entries;
  if (!json.contains(key)) return entries;
  const nlohmann::json& list = json[key];
  if (!list.is_array()) {
    return absl::InvalidArgumentError(absl::StrCat(key, ": want a list"));
  }
  for (size_t i = 0; i < list.size(); ++i) {
    const nlohmann::json& entry = list[i];
    if (!entry.is_object() || !entry.contains("role") ||
        !entry["role"].is_string() || !entry.contains("joint") ||
        !entry["joint"].is_string()) {
      return absl::InvalidArgumentError(absl::StrCat(
          key, "[", i, "]: want \"role\" and \"joint\", both text"));
    }
    entries.push_back({entry["role"], entry["joint"]});
  }
  return entries;
}

absl::StatusOr<BodyFile> BodyOf(const std::string& path,
                                absl::StatusOr<Source> source,
                                absl::Span<const JointMapOverride> overrides) {
  if (!source.ok()) return source.status();
  std::vector<JointMapOverride> roles = RolesOf(*source, overrides);
  absl::StatusOr<MovingBody> body = MakeMovingBody(
      source->skeleton, source->frames, source->frame_time_s, roles);
  if (!body.ok()) return InFile(path, body.status());
  BodyFile file{*std::move(body), BaseName(path), std::move(roles),
                std::move(source->clip), nullptr};
  file.notes.insert(file.notes.begin(), source->warnings.begin(),
                    source->warnings.end());
  if (file.has_motion()) {
    file.frames =
        std::make_shared<const Eigen::MatrixXd>(std::move(source->frames));
  }
  return file;
}

}  // namespace

absl::StatusOr<BodyFile> ReadBodyFile(
    const std::string& path, std::optional<double> unit_m,
    absl::Span<const JointMapOverride> overrides) {
  return BodyOf(path, ReadSource(path, unit_m), overrides);
}

absl::StatusOr<BodyFile> ReadMovingBodyFile(
    const std::string& path, const MotionFileOptions& options,
    absl::Span<const JointMapOverride> overrides) {
  if (IsGltfPath(path)) {
    return BodyOf(path, ReadAnimation(path, options), overrides);
  }
  if (!options.animation.empty()) {
    return InFile(path, absl::InvalidArgumentError(
                            "--animation: only glTF files have several"));
  }
  if (absl::EndsWithIgnoreCase(path, ".amc")) {
    return BodyOf(path, ReadAmc(path, options), overrides);
  }
  return ReadBodyFile(path, options.unit_m, overrides);
}

absl::StatusOr<MapFile> ReadMapFile(const std::string& path) {
  const absl::StatusOr<std::string> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  const nlohmann::json json = nlohmann::json::parse(*bytes, nullptr, false);
  if (!json.is_object() ||
      !(json.contains("source") || json.contains("target"))) {
    return InFile(path, absl::InvalidArgumentError(
                            "want JSON with \"source\" and \"target\""));
  }
  auto source = EntriesFrom(json, "source");
  if (!source.ok()) return InFile(path, source.status());
  auto target = EntriesFrom(json, "target");
  if (!target.ok()) return InFile(path, target.status());
  return MapFile{*std::move(source), *std::move(target)};
}

}  // namespace gelenk::cli
