// Where in its stride a body is, so that clips of other speeds can be laid on
// each other foot by foot.
//
// The phase comes from how far the left foot is ahead of the right one, along
// the way the hips face: at its extremes a foot strikes the ground. That works
// as well on a treadmill as across a field, and without a ground. A step is the
// way from one strike to the next; phase grows by one a step.
#ifndef GELENK_MOTION_GAIT_PHASE_H_
#define GELENK_MOTION_GAIT_PHASE_H_

#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/motion/clip_cut.h"
#include "gelenk/motion/motion_clip.h"

namespace gelenk {

struct GaitPhase {
  // Strikes, left and right in turn.
  std::vector<double> strikes_s;
  bool first_is_left = true;
  // Of each strike, how far that foot is ahead of the other, m.
  std::vector<double> strides_m;
};

// Faster steps than this are tremor, Hz: sprinters take five a second.
inline constexpr double kMaxStepRate_hz = 6;
// A strike's foot gets at least so far ahead, as a part of the clip's largest
// change.
inline constexpr double kMinStride = 0.25;

// FAILED_PRECONDITION where the skeleton has no feet (FindBodyParts) or the
// clip fewer than two strikes.
absl::StatusOr<GaitPhase> FindGaitPhase(const MotionClip& clip);

// For WarpClip: plays the clip of `phase` so that its strikes come when those
// of `reference` do, left on left, from the first on that both have; times are
// from that strike of the reference. Empty where fewer than two are in common.
std::vector<WarpKey> AlignStrikes(const GaitPhase& reference,
                                  const GaitPhase& phase);

// `part` of `second` and the rest of `first` (in [0, 1]), step by step: each
// step takes the weighted mean of both durations, and shows both at the same
// phase, so that feet do not cross. As many steps as both have; starts at the
// first strike of `first` that has its like. A free root of `second` is moved
// on the ground to where `first` starts, and turned to go its way.
// INVALID_ARGUMENT for other skeletons or parts, FAILED_PRECONDITION as
// FindGaitPhase.
absl::StatusOr<MotionClip> BlendGaits(const MotionClip& first,
                                      const MotionClip& second, double part);

}  // namespace gelenk

#endif  // GELENK_MOTION_GAIT_PHASE_H_
