#include "client/cli/skin/skin_source.h"

#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/cli/file_bytes.h"
#include "client/cli/gltf_path.h"
#include "client/cli/skeleton_file.h"
#include "convert/skeleton.h"
#include "convert/skin_surface.h"
#include "gelenk/formats/obj_reader.h"
#include "gelenk/import/gltf_import.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/import/gltf_skin.h"
#include "gelenk/skin/example_shapes.h"

namespace gelenk::cli {
namespace {

absl::Status Refused(const std::string& path, absl::string_view why) {
  return InFile(path, absl::InvalidArgumentError(why));
}

bool IsShape(const std::string& name) {
  const auto names = SkinShapeNames();
  return std::find(names.begin(), names.end(), name) != names.end();
}

v1::VertexWeights WeightsOf(const Skeleton& skeleton,
                            const GltfSkinnedMesh& skinned) {
  v1::VertexWeights proto;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    proto.add_joint_ids(skeleton.joint(i).id);
  }
  proto.set_influences_per_vertex(skinned.weights.influences_per_vertex);
  proto.mutable_joints()->Assign(skinned.weights.joints.begin(),
                                 skinned.weights.joints.end());
  proto.mutable_weights()->Assign(skinned.weights.weights.begin(),
                                  skinned.weights.weights.end());
  for (const WeightedSkin::Affine& matrix : skinned.joint_from_mesh) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        proto.add_joint_from_mesh(matrix(row, column));
      }
    }
  }
  return proto;
}

absl::StatusOr<SkinSource> FromGltf(const SkinSourceOptions& options) {
  const std::string& path = options.path;
  const absl::StatusOr<std::string> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  const absl::StatusOr<GltfDocument> document = ReadGltf(*bytes);
  if (!document.ok()) return InFile(path, document.status());
  const absl::StatusOr<GltfImport> import = ImportGltf(
      *document, {.unit_m = options.unit_m.value_or(1), .skin = options.skin});
  if (!import.ok()) return InFile(path, import.status());
  const absl::StatusOr<GltfSkinnedMesh> skinned =
      ReadGltfSkin(*bytes, *document, *import, {.mesh = options.mesh});
  if (!skinned.ok()) return InFile(path, skinned.status());
  SkinSource source;
  source.warnings = import->warnings;
  source.warnings.insert(source.warnings.end(), skinned->warnings.begin(),
                         skinned->warnings.end());
  convert::ToProto(*import->skeleton, &source.skeleton.emplace());
  source.skeleton->set_display_name(BaseName(path));
  if (options.method == SkinMethod::kLayered) {
    convert::ToProto(RestMesh(*import->skeleton, skinned->mesh,
                              skinned->weights, BindOptions(*skinned)),
                     source.skin.mutable_mesh());
    return source;
  }
  convert::ToProto(skinned->mesh, source.skin.mutable_mesh());
  (options.method == SkinMethod::kLinear
       ? *source.skin.mutable_linear_blend()
       : *source.skin.mutable_dual_quaternion()) =
      WeightsOf(*import->skeleton, *skinned);
  return source;
}

// The skeleton of a file that has none.
absl::Status AddSkeleton(const SkinSourceOptions& options, SkinSource& source) {
  if (options.skeleton_path.empty()) {
    return Refused(options.path, "has no skeleton: give one by --skeleton");
  }
  absl::StatusOr<SkeletonFile> file =
      ReadSkeletonFile(options.skeleton_path, std::nullopt);
  if (!file.ok()) return file.status();
  source.skeleton = std::move(file->message);
  return absl::OkStatus();
}

absl::StatusOr<SkinSource> FromObj(const SkinSourceOptions& options) {
  const absl::StatusOr<std::string> text = ReadFile(options.path);
  if (!text.ok()) return text.status();
  absl::StatusOr<ObjMesh> mesh =
      ReadObj(*text, {.unit_m = options.unit_m.value_or(1)});
  if (!mesh.ok()) return InFile(options.path, mesh.status());
  SkinSource source;
  source.warnings = std::move(mesh->warnings);
  convert::ToProto(mesh->mesh, source.skin.mutable_mesh());
  if (absl::Status status = AddSkeleton(options, source); !status.ok()) {
    return status;
  }
  return source;
}

absl::StatusOr<SkinSource> FromJson(const SkinSourceOptions& options) {
  const absl::StatusOr<std::string> text = ReadFile(options.path);
  if (!text.ok()) return text.status();
  SkinSource source;
  const auto parsed =
      google::protobuf::util::JsonStringToMessage(*text, &source.skin);
  if (!parsed.ok()) {
    return Refused(options.path, absl::StrCat("no skin in proto3 JSON: ",
                                              std::string(parsed.message())));
  }
  source.skin.clear_skeleton();
  if (source.skin.has_shape()) return source;
  if (absl::Status status = AddSkeleton(options, source); !status.ok()) {
    return status;
  }
  return source;
}

absl::StatusOr<SkinSource> ReadAny(const SkinSourceOptions& options) {
  const auto ends_with = [&options](absl::string_view end) {
    return absl::EndsWithIgnoreCase(options.path, end);
  };
  if (IsShape(options.path)) {
    SkinSource source;
    source.skin.mutable_shape()->set_shape_id(options.path);
    source.skin.mutable_shape()->set_vertex_count(
        options.vertex_count.value_or(0));
    return source;
  }
  if (IsGltfPath(options.path)) return FromGltf(options);
  if (ends_with(".obj")) return FromObj(options);
  if (ends_with(".json")) return FromJson(options);
  return absl::InvalidArgumentError(
      absl::StrCat("\"", options.path, "\": want skins/NAME, ",
                   absl::StrJoin(SkinShapeNames(), ", "),
                   ", or a .glb, .gltf, .obj or .json file"));
}

}  // namespace

absl::Status CheckSourceOptions(const SkinSourceOptions& options) {
  const std::string& path = options.path;
  const bool is_gltf = IsGltfPath(path);
  const bool is_obj = absl::EndsWithIgnoreCase(path, ".obj");
  const bool is_json = absl::EndsWithIgnoreCase(path, ".json");
  const struct {
    const char* name;
    bool is_given;
    bool has_meaning;
    const char* of;
  } kOptions[] = {
      {"--skeleton", !options.skeleton_path.empty(), is_obj || is_json,
       "an .obj or .json file"},
      {"--vertices", options.vertex_count.has_value(), IsShape(path),
       "a bundled shape"},
      {"--unit", options.unit_m.has_value(), is_gltf || is_obj,
       "a .glb, .gltf or .obj file"},
      {"--skin", options.skin.has_value(), is_gltf, "a .glb or .gltf file"},
      {"--mesh", options.mesh.has_value(), is_gltf, "a .glb or .gltf file"},
      {"--method", options.method != SkinMethod::kLayered, is_gltf,
       "a .glb or .gltf file, which has weights"},
  };
  for (const auto& option : kOptions) {
    if (!option.is_given || option.has_meaning) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        option.name, ": is of ", option.of, ", not of \"", path, "\""));
  }
  return absl::OkStatus();
}

absl::StatusOr<SkinSource> ReadSkinSource(const SkinSourceOptions& options) {
  absl::StatusOr<SkinSource> source = ReadAny(options);
  if (!source.ok()) return source;
  source->skin.set_display_name(BaseName(options.path));
  return source;
}

}  // namespace gelenk::cli
