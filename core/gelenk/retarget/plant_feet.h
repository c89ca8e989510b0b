// Contact clean-up: a clip whose feet neither slide nor sink.
//
// The clip is retargeted onto its own body with its contacts planned
// (retarget_clip.h): contacts have one place each, feet are kept out of the
// ground, the pelvis shifts so that legs reach. Only what carries the legs is
// taken from that, the root and the joints down to the toes; all else (arms,
// fingers, face) stays as it is, joint by joint.
#ifndef GELENK_RETARGET_PLANT_FEET_H_
#define GELENK_RETARGET_PLANT_FEET_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/motion/motion_clip.h"

namespace gelenk {

struct PlantedClip {
  // Frames at the frame time of the clip, its floor at height 0.
  MotionClip clip;
  // What was found out about the body, and what was left out.
  std::vector<std::string> notes;
};

// FAILED_PRECONDITION where the skeleton has no two legs; other errors as
// MakeMovingBody and FramesFromClip. Cost: that of RetargetClip.
absl::StatusOr<PlantedClip> PlantFeet(const MotionClip& clip);

}  // namespace gelenk

#endif  // GELENK_RETARGET_PLANT_FEET_H_
