#include "client/cli/motion/body_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cli/file_bytes.h"
#include "gelenk/retarget/floating_base.h"
#include "gelenk/retarget/humanoid.h"

namespace gelenk::cli {
namespace {

// A skeleton, from a file or bundled, with the motion that came with it.
struct Source {
  std::shared_ptr<const Skeleton> skeleton;
  std::optional<BvhClip> clip;
  std::vector<std::pair<std::string, std::string>> joint_of_bone;
};

absl::StatusOr<Source> ReadSource(const std::string& path,
                                  std::optional<double> unit_m) {
  const std::vector<absl::string_view> bundled = BundledSkeletonNames();
  if (std::find(bundled.begin(), bundled.end(), path) != bundled.end()) {
    return Source{BundledSkeleton(path).value(), std::nullopt, {}};
  }
  absl::StatusOr<SkeletonFile> file = ReadSkeletonFile(path, unit_m);
  if (!file.ok()) return file.status();
  Source source = {std::move(file->skeleton), std::move(file->clip),
                   std::move(file->joint_of_bone)};
  if (absl::EndsWithIgnoreCase(path, ".urdf")) {
    auto floating = WithFloatingBase(source.skeleton);
    if (!floating.ok()) return InFile(path, floating.status());
    source.skeleton = *std::move(floating);
  }
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

}  // namespace

absl::StatusOr<BodyFile> ReadBodyFile(
    const std::string& path, std::optional<double> unit_m,
    absl::Span<const JointMapOverride> overrides) {
  absl::StatusOr<Source> source = ReadSource(path, unit_m);
  if (!source.ok()) return source.status();
  Eigen::MatrixXd frames;
  double frame_time_s = 0;
  if (source->clip) {
    frames = source->clip->poses;
    frame_time_s = source->clip->document.frame_time_s;
  }
  std::vector<JointMapOverride> roles = RolesOf(*source, overrides);
  absl::StatusOr<MovingBody> body =
      MakeMovingBody(source->skeleton, std::move(frames), frame_time_s, roles);
  if (!body.ok()) return InFile(path, body.status());
  return BodyFile{*std::move(body), BaseName(path), std::move(roles),
                  std::move(source->clip)};
}

absl::StatusOr<MapFile> ReadMapFile(const std::string& path) {
  const absl::StatusOr<std::string> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  const nlohmann::json json = nlohmann::json::parse(*bytes, nullptr, false);
  if (!json.is_object()) {
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
