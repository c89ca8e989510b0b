#include "client/cli/skeleton_file.h"

#include <filesystem>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cli/file_bytes.h"
#include "client/cli/gltf_path.h"
#include "convert/skeleton.h"
#include "gelenk/import/gltf_import.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/import/urdf_import.h"
#include "gelenk/import/urdf_reader.h"

namespace gelenk::cli {
namespace {

// What the importers have in common.
SkeletonFile Imported(const std::string& path,
                      std::shared_ptr<const Skeleton> skeleton,
                      const std::vector<std::string>& warnings) {
  SkeletonFile file;
  file.path = path;
  file.skeleton = std::move(skeleton);
  convert::ToProto(*file.skeleton, &file.message);
  file.message.set_display_name(BaseName(path));
  for (const std::string& warning : warnings) {
    file.message.add_warnings(warning);
  }
  return file;
}

absl::StatusOr<SkeletonFile> FromClip(const std::string& path,
                                      absl::StatusOr<BvhClip> clip) {
  if (!clip.ok()) return clip.status();
  SkeletonFile file =
      Imported(path, clip->import.skeleton, clip->import.warnings);
  file.clip = *std::move(clip);
  return file;
}

absl::StatusOr<SkeletonFile> FromUrdf(const std::string& path) {
  const absl::StatusOr<std::string> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  const absl::StatusOr<UrdfDocument> document = ReadUrdf(*bytes);
  if (!document.ok()) return InFile(path, document.status());
  const absl::StatusOr<UrdfImport> import = ImportUrdf(*document);
  if (!import.ok()) return InFile(path, import.status());
  return Imported(path, import->skeleton, import->warnings);
}

absl::StatusOr<SkeletonFile> FromGltf(const std::string& path,
                                      const GltfImportOptions& options) {
  const absl::StatusOr<std::string> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  const absl::StatusOr<GltfDocument> document = ReadGltf(*bytes);
  if (!document.ok()) return InFile(path, document.status());
  const absl::StatusOr<GltfImport> import = ImportGltf(*document, options);
  if (!import.ok()) return InFile(path, import.status());
  SkeletonFile file = Imported(path, import->skeleton, import->warnings);
  file.joint_of_bone = JointsOfBones(*document, *import);
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

std::vector<std::pair<std::string, std::string>> JointsOfBones(
    const GltfDocument& document, const GltfImport& import) {
  std::vector<std::pair<std::string, std::string>> joints;
  for (const GltfHumanBone& bone : document.humanoid) {
    const int joint = import.joint_of_node[bone.node];
    if (joint < 0) continue;
    joints.emplace_back(bone.bone, import.skeleton->joint(joint).id);
  }
  return joints;
}

std::string BaseName(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

absl::StatusOr<SkeletonFile> ReadSkeletonFile(
    const std::string& path, std::optional<double> unit_m,
    const std::optional<std::string>& skin) {
  const auto ends_with = [&path](absl::string_view end) {
    return absl::EndsWithIgnoreCase(path, end);
  };
  const bool is_gltf = IsGltfPath(path);
  if (skin && !is_gltf) {
    return InFile(
        path, absl::InvalidArgumentError("--skin: only glTF files have skins"));
  }
  if (is_gltf) {
    return FromGltf(path, {.unit_m = unit_m.value_or(1), .skin = skin});
  }
  if (ends_with(".bvh")) return FromClip(path, ReadBvhClip(path, unit_m));
  if (ends_with(".asf")) return FromClip(path, ReadAsfClip(path, "", unit_m));
  if (ends_with(".urdf")) {
    if (!unit_m) return FromUrdf(path);
    return InFile(path,
                  absl::InvalidArgumentError("--unit: a URDF is in metres"));
  }
  if (ends_with(".json")) return FromJson(path);
  return absl::InvalidArgumentError(absl::StrCat(
      "\"", path,
      "\": want a .bvh, .asf, .urdf, .gltf, .glb, .vrm or .json file"));
}

}  // namespace gelenk::cli
