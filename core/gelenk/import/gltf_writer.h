// Writes a clip as glTF 2.0: a node per joint and end effector, a skin that
// names the joints, one animation. Numbers are in single precision, as the
// format wants them.
//
// Tracks of spherical and free joints stay what they are (STEP, LINEAR,
// CUBICSPLINE); what the format does not have (Catmull-Rom, hinges, sliders,
// mimics) is sampled at the clip's frame time.
#ifndef GELENK_IMPORT_GLTF_WRITER_H_
#define GELENK_IMPORT_GLTF_WRITER_H_

#include <string>

#include "absl/status/statusor.h"
#include "gelenk/import/gltf_form.h"
#include "gelenk/motion/motion_clip.h"

namespace gelenk {

// Reads back (ReadGltf, ImportGltf, ReadGltfAnimations, ClipFromGltf) as the
// same motion in single precision, with the clip's base pose for rest. Errors:
// those of FramesFromClip. Cost: linear in the keys.
absl::StatusOr<std::string> WriteGltf(const MotionClip& clip, GltfForm form);

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_WRITER_H_
