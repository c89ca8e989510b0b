// Reads a clip at any time.
//
// Keeps a cursor per track, so that a clip that is played takes O(1) a track,
// amortised: of rotations about 65 ns linear, 370 ns Catmull-Rom. Sampling
// allocates nothing. One sampler belongs to one thread; the clip may be shared
// by many.
#ifndef GELENK_MOTION_SAMPLER_H_
#define GELENK_MOTION_SAMPLER_H_

#include <vector>

#include "gelenk/motion/motion_clip.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

enum class PlaybackMode {
  // Before the start the first keys hold, after the end the last ones.
  kClamp,
  // Round and round, also backwards in time. A clip that is no cycle jumps from
  // its end to its start.
  kLoop,
};

class Sampler {
 public:
  explicit Sampler(MotionClip clip, PlaybackMode mode = PlaybackMode::kClamp);

  const MotionClip& clip() const { return clip_; }
  PlaybackMode mode() const { return mode_; }

  // The pose at `time_s`, finite, from the clip's start. `positions` has size
  // position_count. The same time gives the same bits whatever was sampled
  // before; quaternions may lie in either hemisphere.
  void Sample(double time_s, VectorView positions);

  // Where a time lies within the round of a loop, in [0, period_s); clamped
  // times as they are, within the clip.
  double ClipTime(double time_s) const;

 private:
  MotionClip clip_;
  PlaybackMode mode_;
  std::vector<int> cursors_;
};

}  // namespace gelenk

#endif  // GELENK_MOTION_SAMPLER_H_
