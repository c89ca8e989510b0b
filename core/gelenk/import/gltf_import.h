// Makes a Skeleton of the nodes of a glTF file.
//
// Which nodes are joints: see gltf_joints.h. The root becomes a free joint that
// rests where the file has it: its coordinates are those of the world, and what
// is above it in the file is part of them. Every other joint is spherical; its
// rest rotation is in parent_from_joint, so that a rest pose is all identities
// but for the root. Where several joints hang from nothing, each is free, below
// a fixed root of their own. Nodes below joints that are none themselves are
// end effectors. Up is +Y.
//
// Skeletons are rigid, nodes may be scaled: lengths are those that the scene
// shows in the rest pose. A scale that is the same along all axes is exact in
// every other pose too; one that is not, or a shear, is near. What is mirrored
// has no rigid frame and is refused.
#ifndef GELENK_IMPORT_GLTF_IMPORT_H_
#define GELENK_IMPORT_GLTF_IMPORT_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/import/gltf_document.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {

struct GltfImportOptions {
  // Length of the file's unit, m. The format says 1; some exporters differ.
  double unit_m = 1;
  // Name or index of the skin; unset means the one with the most joints.
  std::optional<std::string> skin = std::nullopt;
  SkeletonBounds bounds = {};
};

struct GltfImport {
  std::shared_ptr<const Skeleton> skeleton;
  // Of each node of the document, the index of its joint; -1 for none. Names
  // may have changed, this is what binds.
  std::vector<int> joint_of_node;
  // As the options had it.
  double unit_m = 1;
  // What was chosen or changed: skin, names, scale, size.
  std::vector<std::string> warnings;
};

// Errors: INVALID_ARGUMENT naming `unit_m`, `skin` or the node, or what
// SkeletonBuilder refuses. Cost: linear in the document.
absl::StatusOr<GltfImport> ImportGltf(const GltfDocument& document,
                                      const GltfImportOptions& options = {});

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_IMPORT_H_
