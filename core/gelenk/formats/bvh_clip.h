// BVH files as clips, and clips as BVH files.
#ifndef GELENK_FORMATS_BVH_CLIP_H_
#define GELENK_FORMATS_BVH_CLIP_H_

#include <string>

#include "absl/status/statusor.h"
#include "gelenk/formats/bvh_document.h"
#include "gelenk/formats/bvh_import.h"
#include "gelenk/motion/motion_clip.h"

namespace gelenk {

// The motion of `document`, one key a frame, at its frame time to the last bit.
// Errors as PosesFromBvh; also INVALID_ARGUMENT without frames or with a frame
// time that is not > 0.
absl::StatusOr<MotionClip> ClipFromBvh(const BvhDocument& document,
                                       const BvhImport& import,
                                       std::string name = "");

// `form` with the motion of `clip`, which is of the skeleton of `import` or of
// one with the same numbers. At the clip's frame time; a clip without one takes
// that of `form`. A clip that came from a file goes back into it frame by
// frame.
absl::StatusOr<BvhDocument> BvhFromClip(const BvhDocument& form,
                                        const BvhImport& import,
                                        const MotionClip& clip);

// Any clip as a BVH file of its own, without a form: a joint per joint, ZXY
// rotations, positions too for the root and for what slides; end effectors are
// End Sites. The format knows no rest rotation, so that these are part of the
// angles: the file's zero pose is not the skeleton's, every frame's world is.
// Braces in names become underscores. Lengths in units of `unit_m`; at the
// clip's frame time (see FrameTimeOf). INVALID_ARGUMENT unless unit_m > 0.
absl::StatusOr<BvhDocument> BvhFromClip(const MotionClip& clip,
                                        double unit_m = 0.01);

}  // namespace gelenk

#endif  // GELENK_FORMATS_BVH_CLIP_H_
