// Which nodes of a glTF file are the joints of a skeleton.
#ifndef GELENK_IMPORT_GLTF_JOINTS_H_
#define GELENK_IMPORT_GLTF_JOINTS_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/import/gltf_document.h"

namespace gelenk {

struct GltfJoints {
  // Nodes, parents first.
  std::vector<int> nodes;
  // Places in `nodes`: of each joint's parent, -1 for one that hangs from none.
  std::vector<int> parents;
  // Per node of the document the nearest joint at or above it, as a place in
  // `nodes`; -1 for none.
  std::vector<int> place_above;
  // Of what the joints come from: a skin or a scene. May be empty.
  std::string name;
  std::vector<std::string> warnings;
};

// The joints of one skin: the one that is called `skin` or has that index, else
// the one with the most joints; with those of other skins that share joints
// with it. Nodes between joints are joints too where an animation turns them.
// Joints that hang from no common one get the nearest node above all of them as
// their root, if there is one. Without skins every node that the scene shows is
// a joint.
//
// Errors: INVALID_ARGUMENT when there is no such skin, or no node.
absl::StatusOr<GltfJoints> FindGltfJoints(
    const GltfDocument& document, const std::optional<std::string>& skin);

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_JOINTS_H_
