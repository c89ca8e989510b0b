#include "client/cli/motion/motion_file.h"

#include <filesystem>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/cli/file_bytes.h"
#include "client/cli/gltf_path.h"
#include "client/cli/skeleton_file.h"
#include "gelenk/formats/bvh_clip.h"
#include "gelenk/import/gltf_animation.h"
#include "gelenk/import/gltf_clip.h"
#include "gelenk/import/gltf_import.h"
#include "gelenk/import/gltf_reader.h"

namespace gelenk::cli {
namespace {

// Reads buffers beside the file, and nothing that is elsewhere.
OpenUri OpenBeside(const std::string& path) {
  return [folder = std::filesystem::path(path).parent_path()](
             absl::string_view uri) -> absl::StatusOr<std::string> {
    const std::filesystem::path name{std::string(uri)};
    if (name.empty() || name != name.filename()) {
      return absl::InvalidArgumentError(
          absl::StrCat("want a file in the same folder, got \"", uri, "\""));
    }
    return ReadFile((folder / name).string());
  };
}

absl::StatusOr<MotionFile> MotionOf(const std::string& path,
                                    absl::StatusOr<BvhClip> file) {
  if (!file.ok()) return file.status();
  absl::StatusOr<MotionClip> clip =
      ClipFromBvh(file->document, file->import, BaseName(path));
  if (!clip.ok()) return InFile(path, clip.status());
  MotionFile motion{.clip = *std::move(clip)};
  motion.unit_m = file->import.unit_m;
  motion.warnings = file->import.warnings;
  motion.form = *std::move(file);
  return motion;
}

// The index of the animation that `wanted` names; a name goes before a number.
absl::StatusOr<int> FindAnimation(const std::vector<GltfAnimation>& animations,
                                  const std::string& wanted) {
  if (wanted.empty()) return 0;
  const int count = static_cast<int>(animations.size());
  for (int i = 0; i < count; ++i) {
    if (animations[i].name == wanted) return i;
  }
  int index = -1;
  if (absl::SimpleAtoi(wanted, &index) && index >= 0 && index < count) {
    return index;
  }
  const std::string names = absl::StrJoin(
      animations, ", ", [](std::string* text, const GltfAnimation& animation) {
        absl::StrAppend(text, "\"", animation.name, "\"");
      });
  return absl::InvalidArgumentError(
      absl::StrCat("--animation: want 0 to ", count - 1, " or one of ", names,
                   ", got \"", wanted, "\""));
}

absl::StatusOr<MotionFile> ReadGltfMotion(const std::string& path,
                                          const MotionFileOptions& options) {
  const absl::StatusOr<std::string> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  const absl::StatusOr<GltfDocument> document = ReadGltf(*bytes);
  if (!document.ok()) return InFile(path, document.status());
  const absl::StatusOr<GltfImport> import =
      ImportGltf(*document, {.unit_m = options.unit_m.value_or(1)});
  if (!import.ok()) return InFile(path, import.status());
  const absl::StatusOr<std::vector<GltfAnimation>> animations =
      ReadGltfAnimations(*bytes, *document, OpenBeside(path));
  if (!animations.ok()) return InFile(path, animations.status());
  if (animations->empty()) {
    return InFile(path,
                  absl::InvalidArgumentError("the file has no animation"));
  }
  const absl::StatusOr<int> index =
      FindAnimation(*animations, options.animation);
  if (!index.ok()) return InFile(path, index.status());
  absl::StatusOr<GltfClip> clip =
      ClipFromGltf((*animations)[*index], *document, *import);
  if (!clip.ok()) return InFile(path, clip.status());
  MotionFile motion{.clip = std::move(clip->clip)};
  motion.animation_index = *index;
  motion.unit_m = import->unit_m;
  motion.warnings = import->warnings;
  motion.warnings.insert(motion.warnings.end(), clip->warnings.begin(),
                         clip->warnings.end());
  for (const GltfAnimation& animation : *animations) {
    motion.animation_names.push_back(animation.name);
  }
  motion.joint_of_bone = JointsOfBones(*document, *import);
  return motion;
}

}  // namespace

void AddAnimationOption(CLI::App& app, const std::string& name,
                        std::string* animation) {
  app.add_option(name, *animation,
                 "Which animation of a glTF file, by name or index; default 0")
      ->option_text("NAME|INDEX");
}

void AddSkeletonOption(CLI::App& app, std::string* path) {
  app.add_option("--skeleton", *path, "The skeleton of an .amc file")
      ->option_text("FILE.asf");
}

absl::StatusOr<BvhClip> ReadAmcClip(const std::string& path,
                                    const MotionFileOptions& options) {
  if (options.skeleton_path.empty()) {
    return InFile(path, absl::InvalidArgumentError(
                            "--skeleton: want the .asf file that this moves"));
  }
  return ReadAsfClip(options.skeleton_path, path, options.unit_m);
}

absl::StatusOr<MotionFile> ReadMotionFile(const std::string& path,
                                          const MotionFileOptions& options) {
  if (IsGltfPath(path)) {
    return ReadGltfMotion(path, options);
  }
  const bool is_amc = absl::EndsWithIgnoreCase(path, ".amc");
  if (!is_amc && !absl::EndsWithIgnoreCase(path, ".bvh")) {
    return InFile(path, absl::InvalidArgumentError(
                            "want a .bvh, .amc, .gltf, .glb or .vrm file"));
  }
  if (!options.animation.empty()) {
    return InFile(path, absl::InvalidArgumentError(
                            "--animation: the file has only one motion"));
  }
  return MotionOf(path, is_amc ? ReadAmcClip(path, options)
                               : ReadBvhClip(path, options.unit_m));
}

}  // namespace gelenk::cli
