#include "gelenk/motion/sampler.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gelenk {

Sampler::Sampler(MotionClip clip, PlaybackMode mode)
    : clip_(std::move(clip)), mode_(mode), cursors_(clip_.track_count(), 0) {}

double Sampler::ClipTime(double time_s) const {
  const double period_s = clip_.period_s();
  if (mode_ == PlaybackMode::kClamp || period_s <= 0) {
    return std::clamp(time_s, 0.0, clip_.duration_s());
  }
  double within_s = std::fmod(time_s, period_s);
  if (within_s < 0) within_s += period_s;
  // A tiny negative time may have been rounded up to a whole round.
  return within_s < period_s ? within_s : 0;
}

void Sampler::Sample(double time_s, VectorView positions) {
  const double clip_time_s = ClipTime(time_s);
  positions = clip_.properties().base_positions;
  const double after_end_s = clip_time_s - clip_.duration_s();
  if (after_end_s > 0) {
    const double seam_s = *clip_.properties().seam_s;
    for (int i = 0; i < clip_.track_count(); ++i) {
      clip_.curve(i).SampleSeam(after_end_s / seam_s, seam_s, positions.data());
    }
    return;
  }
  for (int i = 0; i < clip_.track_count(); ++i) {
    clip_.curve(i).Sample(clip_time_s, cursors_[i], positions.data());
  }
}

}  // namespace gelenk
