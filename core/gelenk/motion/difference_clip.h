// What one motion does beyond another, for additive layers: a limp without the
// walk that it was recorded in.
#ifndef GELENK_MOTION_DIFFERENCE_CLIP_H_
#define GELENK_MOTION_DIFFERENCE_CLIP_H_

#include "absl/status/statusor.h"
#include "gelenk/motion/motion_clip.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

// Frames at the frame time of `clip`, each the motion from the base to it,
// written as a pose from the neutral one: numbers subtracted, rotations
// base^-1 * own. An additive layer of weight 1 on the base gives `clip` again.
// INVALID_ARGUMENT for another skeleton, or a pose that CheckPositions refuses.
absl::StatusOr<MotionClip> DifferenceClip(const MotionClip& clip,
                                          const ConstVectorView& base_pose);

// Time by time: the shorter base holds its last pose.
absl::StatusOr<MotionClip> DifferenceClip(const MotionClip& clip,
                                          const MotionClip& base);

}  // namespace gelenk

#endif  // GELENK_MOTION_DIFFERENCE_CLIP_H_
