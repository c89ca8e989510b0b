// Parts of a clip, other rates, other speeds.
#ifndef GELENK_MOTION_CLIP_CUT_H_
#define GELENK_MOTION_CLIP_CUT_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/motion/motion_clip.h"

namespace gelenk {

// From `start_s` to `end_s` (within the clip, the one before the other), from 0
// on. Steps and straight lines keep their keys and get one at each end; cubics
// become frames at the clip's frame time. It is no cycle any more.
absl::StatusOr<MotionClip> CropClip(const MotionClip& clip, double start_s,
                                    double end_s);

// The clip without what comes before its motion: see CountFramesBeforeMotion.
// With nothing before, the clip as it is; else frames at its frame time.
struct MotionPart {
  MotionClip clip;
  // Frames that were left out.
  int frames_before = 0;
};
absl::StatusOr<MotionPart> CutToMotion(const MotionClip& clip);

// What people should know of it; empty where nothing was left out.
std::string LeftOutText(int frames_before);

// As frames of another rate; the end is cut to whole frames.
absl::StatusOr<MotionClip> ResampleClip(const MotionClip& clip,
                                        double frame_time_s);

// When what of the clip is shown: straight lines between.
struct WarpKey {
  double time_s = 0;
  double clip_time_s = 0;
};

// The clip played as `keys` say, as frames at its frame time from 0 to the last
// key's time. At least two keys; both times rise from key to key (so that
// nothing stands or runs backwards), the first at 0.
absl::StatusOr<MotionClip> WarpClip(const MotionClip& clip,
                                    const std::vector<WarpKey>& keys);

}  // namespace gelenk

#endif  // GELENK_MOTION_CLIP_CUT_H_
