// An animation of a glTF file as a clip of the skeleton that ImportGltf makes.
//
// Channels bind by the index of their node. A joint below the root turns only:
// its keys become rotations from its rest. A free root has its keys in the
// world, what is above it in the file (turned, scaled) included. Both are
// linear maps of the keys, so that STEP, LINEAR and CUBICSPLINE stay exactly
// what they are. Keys that are spaced evenly, 10 to 1000 a second, are frames,
// and tell the clip's frame time; otherwise it has none.
#ifndef GELENK_IMPORT_GLTF_CLIP_H_
#define GELENK_IMPORT_GLTF_CLIP_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/import/gltf_animation.h"
#include "gelenk/import/gltf_document.h"
#include "gelenk/import/gltf_import.h"
#include "gelenk/motion/motion_clip.h"

namespace gelenk {

struct GltfClip {
  MotionClip clip;
  // What a rigid skeleton cannot do and how far that goes: translations below
  // the root and scales that leave the rest pose, nodes that are no joints.
  std::vector<std::string> warnings;
};

// Errors: INVALID_ARGUMENT as MotionClip::Create. Cost: linear.
absl::StatusOr<GltfClip> ClipFromGltf(const GltfAnimation& animation,
                                      const GltfDocument& document,
                                      const GltfImport& import);

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_CLIP_H_
