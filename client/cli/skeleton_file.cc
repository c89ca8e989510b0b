#include "client/cli/skeleton_file.h"

#include <filesystem>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cli/file_bytes.h"
#include "convert/skeleton.h"

namespace gelenk::cli {
namespace {

absl::StatusOr<SkeletonFile> FromBvh(const std::string& path,
                                     std::optional<double> unit_m) {
  absl::StatusOr<BvhClip> clip = ReadBvhClip(path, unit_m);
  if (!clip.ok()) return clip.status();
  SkeletonFile file;
  file.path = path;
  file.skeleton = clip->import.skeleton;
  convert::ToProto(*file.skeleton, &file.message);
  file.message.set_display_name(BaseName(path));
  for (const std::string& warning : clip->import.warnings) {
    file.message.add_warnings(warning);
  }
  file.clip = *std::move(clip);
  return file;
}

absl::StatusOr<SkeletonFile> FromJson(const std::string& path) {
  const absl::StatusOr<std::string> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  absl::StatusOr<v1::Skeleton> message = convert::SkeletonFromJson(*bytes);
  if (!message.ok()) return InFile(path, message.status());
  auto skeleton = convert::FromProto(*message);
  if (!skeleton.ok()) return InFile(path, skeleton.status());
  SkeletonFile file;
  file.path = path;
  file.skeleton = *std::move(skeleton);
  file.message = *std::move(message);
  // In the order in which positions are counted, with what is output only.
  convert::ToProto(*file.skeleton, &file.message);
  if (file.message.display_name().empty()) {
    file.message.set_display_name(BaseName(path));
  }
  return file;
}

}  // namespace

std::string BaseName(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

absl::StatusOr<SkeletonFile> ReadSkeletonFile(const std::string& path,
                                              std::optional<double> unit_m) {
  if (absl::EndsWithIgnoreCase(path, ".bvh")) return FromBvh(path, unit_m);
  if (absl::EndsWithIgnoreCase(path, ".json")) return FromJson(path);
  return absl::InvalidArgumentError(
      absl::StrCat("\"", path, "\": want a .bvh or .json file"));
}

}  // namespace gelenk::cli
