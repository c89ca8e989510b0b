// Writes a layered skin as a plain glTF 2.0 skin, which every engine shows.
//
// Every control plane becomes a joint of its own below one root, every vertex
// follows the four of its volume by the Bernstein polynomials of its place (see
// linear_blend_export.h): the inverse bind matrices are the identity, and
// positions are in the frames of their joints. Nodes stand at the bind pose;
// poses become an animation of the joints. Numbers are in single precision.
//
// Not exact: vertices that branches share (they are counted), and the mitre of
// a JointFullness, whose shear the format's nodes do not have.
#ifndef GELENK_IMPORT_GLTF_SKIN_WRITER_H_
#define GELENK_IMPORT_GLTF_SKIN_WRITER_H_

#include <Eigen/Core>
#include <string>

#include "absl/types/span.h"
#include "gelenk/import/gltf_form.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/skin/layered_skin.h"

namespace gelenk {

// A pose of the skin's skeleton, and where the actor stands in it.
struct SkinKey {
  Eigen::VectorXd positions;
  RigidTransform world_from_skeleton;
};

struct GltfSkinFile {
  std::string bytes;
  int inexact_vertex_count = 0;
};

// `keys` are `frame_time_s` > 0 apart; none makes no animation. Cost: linear in
// vertices, and in links times keys.
GltfSkinFile WriteGltfSkin(const LayeredSkin& skin,
                           absl::Span<const SkinKey> keys, double frame_time_s,
                           GltfForm form);

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_SKIN_WRITER_H_
