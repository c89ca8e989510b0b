// The meshes of a glTF file on the skeleton that ImportGltf makes of it: what a
// WeightedSkin is made of, or a LayeredSkin bound to.
//
// All meshes of the shown scene that the skeleton's joints move are joined:
// those with a skin all of whose joints are the skeleton's, and rigid ones that
// hang from a joint. A pose then deforms them as the format says,
// sum of weight * scene_from_joint * inverse bind matrix, but for what a rigid
// skeleton cannot do (see gltf_import.h: uneven scales above joints).
//
// Nothing is opened: a buffer in another file is an error, unless `open_uri`
// reads it.
#ifndef GELENK_IMPORT_GLTF_SKIN_H_
#define GELENK_IMPORT_GLTF_SKIN_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/import/gltf_animation.h"
#include "gelenk/import/gltf_document.h"
#include "gelenk/import/gltf_import.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/skin/triangle_mesh.h"
#include "gelenk/skin/weighted_skin.h"

namespace gelenk {

struct GltfSkinOptions {
  // Name or index of the one mesh to take; unset means all.
  std::optional<std::string> mesh = std::nullopt;
  MeshBounds bounds = {};
};

struct GltfSkinnedMesh {
  // As it was bound, in the skeleton's frame, m. Where the file's bind pose is
  // its rest pose, as nearly always, that is the rest pose; else see RestMesh.
  TriangleMesh mesh;
  // By the skeleton's joints, normalised; as many a vertex as any one needs.
  SkinWeights weights;
  // One a joint of the skeleton.
  std::vector<WeightedSkin::Affine> joint_from_mesh;
  // What was left out or changed.
  std::vector<std::string> warnings;
};

// `document` and `import` are what ReadGltf and ImportGltf make of the same
// bytes.
//
// Errors: INVALID_ARGUMENT with the path: as ReadGltfMesh; no such mesh, or
// none on this skeleton; joints beyond the skin; inverse bind matrices that are
// too few or not affine; a joint that two meshes bind in different places.
// Cost: linear.
absl::StatusOr<GltfSkinnedMesh> ReadGltfSkin(
    absl::string_view bytes, const GltfDocument& document,
    const GltfImport& import, const GltfSkinOptions& options = {},
    const OpenUri& open_uri = nullptr, const GltfBounds& bounds = {});

// The WeightedSkin's options that bind `skinned` as the file does.
WeightedSkin::Options BindOptions(const GltfSkinnedMesh& skinned,
                                  BlendMethod method = BlendMethod::kLinear);

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_SKIN_H_
