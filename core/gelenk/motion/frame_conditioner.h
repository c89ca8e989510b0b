// Cleans the frames of a live stream and tells what stands for those that do
// not come: LiveClock and Smoother behind one another.
//
//   Take(frame) ... Sample() -> what to use now
//
// Without a jitter buffer time is that of the captures: a frame that came is
// used as it is, filtered, and one that is missing is asked for by the time at
// which it should have been captured; the answers depend on nothing else. With
// one, time is that of arrivals, and what is used lies `latency_s` behind the
// fastest frame.
//
// Take and Sample allocate nothing. Not thread-safe.
#ifndef GELENK_MOTION_FRAME_CONDITIONER_H_
#define GELENK_MOTION_FRAME_CONDITIONER_H_

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "absl/status/statusor.h"
#include "gelenk/math/state_numbers.h"
#include "gelenk/motion/live_clock.h"
#include "gelenk/motion/smoother.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct ConditioningOptions {
  SmootherOptions smoother = {.kind = SmootherOptions::Kind::kNone};
  // 0 to kMaxJitterFrames, each of `frame_interval_s`.
  int jitter_frames = 0;
  double frame_interval_s = 0;
  LatePolicy late_policy = LatePolicy::kHold;
  double max_extrapolation_s = 0.1;
  double ease_s = 0.3;
  // Whoever calls Take and Sample asks by himself when no frame came for so
  // long; 0: never.
  double fill_interval_s = 0;

  // How far behind the fastest frame what is used lies.
  double delay_s() const { return jitter_frames * frame_interval_s; }
};

// The fastest way of a frame is looked for among those of this time; clocks
// drift by less than a millisecond in it.
inline constexpr double kClockWindow_s = 10;

// More is no live stream.
inline constexpr int kMaxJitterFrames = 32;
// No screen is faster, and a stream that waits wakes no more often; a viewer
// who waits longer takes the actor for gone.
inline constexpr double kMinFillInterval_s = 0.002;
inline constexpr double kMaxFillInterval_s = 10;

class FrameConditioner {
 public:
  // `rest` is where kExtrapolate eases to, its root where it is; empty: where
  // the motion has come to. INVALID_ARGUMENT listing bad options.
  static absl::StatusOr<FrameConditioner> Create(
      std::shared_ptr<const Skeleton> skeleton,
      const ConditioningOptions& options, const Eigen::VectorXd& rest = {});

  const ConditioningOptions& options() const { return options_; }

  // A frame that came, checked, its capture after that of the one before.
  void Take(double capture_s, double arrival_s,
            const ConstVectorView& positions);
  bool has_frame() const { return frame_count_ > 0; }

  // What to use at that moment, not before an earlier one: by `capture_s`, or
  // by `arrival_s` with a jitter buffer. `positions` is left alone where the
  // state is kEmpty.
  LiveStatus Sample(double capture_s, double arrival_s, VectorView positions);

  // How far the last sample lags behind the frames.
  double latency_s() const;

  // The next frame is a first one, by another clock.
  void Reset();
  // All that later samples depend on; with a jitter buffer the times of
  // arrival, too.
  void Exchange(StateNumbers& state);

 private:
  FrameConditioner(std::shared_ptr<const Skeleton> skeleton,
                   const ConditioningOptions& options, LiveClock clock,
                   Smoother smoother);

  std::shared_ptr<const Skeleton> skeleton_;
  ConditioningOptions options_;
  LiveClock clock_;
  Smoother smoother_;
  int64_t frame_count_ = 0;
};

}  // namespace gelenk

#endif  // GELENK_MOTION_FRAME_CONDITIONER_H_
