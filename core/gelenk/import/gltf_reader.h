// Reads nodes, skins and scenes of glTF 2.0, as JSON or as GLB.
//
// Nothing else of the file is looked at: no buffer, image or URI is decoded and
// no other file is ever opened, so that a .gltf reads without its .bin.
//
// Errors: INVALID_ARGUMENT that lists all that is malformed, as
// `nodes[3].children[0]: want a node, 0 to 11, got 99`: numbers that are none,
// indices out of range, nodes with two parents or in a circle, quaternions that
// are not near unit. Cost: linear, about 100 MB/s of JSON.
#ifndef GELENK_IMPORT_GLTF_READER_H_
#define GELENK_IMPORT_GLTF_READER_H_

#include <cstddef>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/import/gltf_document.h"

namespace gelenk {

// Largest files taken.
struct GltfBounds {
  // Most of a GLB is meshes and pictures, which are not looked at.
  size_t max_bytes = size_t{256} << 20;
  // Of JSON, which may have data embedded; more of it belongs into a GLB.
  size_t max_json_bytes = size_t{64} << 20;
  // Nodes are 3 levels deep, whatever the depth of their tree.
  size_t max_json_depth = 64;
  // Nodes have about 15 each. They take 16 bytes, as members of objects 150.
  size_t max_json_values = 2'000'000;
  size_t max_nodes = 65'536;
  // Of all animations' channels together, which may share few bytes: a day of a
  // body at 60 Hz.
  size_t max_animation_numbers = size_t{1} << 26;
};

absl::StatusOr<GltfDocument> ReadGltf(absl::string_view bytes,
                                      const GltfBounds& bounds = {});

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_READER_H_
