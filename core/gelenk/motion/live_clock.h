// Plays frames from a network at the pace at which they were captured.
//
// A frame carries the time of its capture by the sender's clock and comes at a
// time by ours. The smallest difference seen within a window is the offset of
// the clocks plus the fastest way; what a frame takes longer is jitter. The
// player shows the sender's time `delay_s` behind that, which is the jitter
// buffer: frames up to so much late, less one spacing, are in time, evenly
// spaced again, and interpolated. Zero delay shows each frame as it comes.
//
// When the next frame is late, the policy says what is shown: the last frame
// holds; or its motion goes on, no further than `max_extrapolation_s`, slows
// down, and eases to `rest` (or stays); or nothing (drop: no pose until a frame
// comes). When frames come again after an extrapolation over a frame that was
// missing, the error fades over `ease_s` instead of popping. A frame is missing
// when none came for 1.5 times the spacing of the last two.
//
// Pure: all times come in, in seconds, from any origin; nothing waits.
// Push and Sample allocate nothing.
#ifndef GELENK_MOTION_LIVE_CLOCK_H_
#define GELENK_MOTION_LIVE_CLOCK_H_

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/math/state_numbers.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// The offset between two clocks by the running minimum of (arrival - capture).
class ClockOffset {
 public:
  // The minimum is over the last `window_s` of arrivals, so that drifting
  // clocks are followed; kept in kSlots slots.
  explicit ClockOffset(double window_s);

  void Note(double capture_s, double arrival_s);

  // arrival - capture of the fastest frame; unset before the first.
  std::optional<double> offset_s() const;

  void Exchange(StateNumbers& state);

 private:
  static constexpr int kSlots = 8;

  double slot_s_;
  // Minimum of each slot and its number; slots older than the window count no
  // more.
  double minima_s_[kSlots];
  int64_t slots_[kSlots];
  int64_t newest_slot_ = 0;
  bool has_any_ = false;
};

enum class LatePolicy {
  kHold,
  kExtrapolate,
  kDrop,
};

struct LiveClockOptions {
  // The jitter buffer, s, >= 0.
  double delay_s = 0;
  // Of the running minimum, s, > 0.
  double window_s = 10;
  LatePolicy late_policy = LatePolicy::kHold;
  // kExtrapolate: how far the motion goes on and, after that, how long it takes
  // to get to `rest`; > 0.
  double max_extrapolation_s = 0.1;
  double ease_s = 0.3;
  // Empty: where the extrapolation ended.
  Eigen::VectorXd rest = {};
  // The root, or what stands for it, does not go to rest: it stays.
  bool keeps_root = false;
  // Frames waiting to be shown, at least 2; the oldest give way.
  int capacity = 64;
};

struct LiveStatus {
  enum class State {
    kEmpty,          // no frame has come, or kDrop and late: no pose
    kWaiting,        // the first frame is not due yet: it is shown
    kPlaying,        // between two frames, or at one
    kHolding,        // the last one, late
    kExtrapolating,  // beyond the last one
    kEasing,         // to rest
  };
  State state = State::kEmpty;
  // Between the capture of what is shown (the frame before) and now, by the
  // offset: how old the picture is beyond the fastest way. 0 without frames.
  double age_s = 0;
  // Sequence number of the frame at or before; -1 without.
  int64_t sequence_number = -1;
  // Later samples are the same until a frame comes.
  bool is_settled = false;
};

class LiveClock {
 public:
  // INVALID_ARGUMENT listing options out of range.
  static absl::StatusOr<LiveClock> Create(
      std::shared_ptr<const Skeleton> skeleton, LiveClockOptions options);

  // A frame, its pose checked. False, and counted, where its number or its
  // capture time is not after that of the newest: out of order.
  bool Push(int64_t sequence_number, double capture_s, double arrival_s,
            const ConstVectorView& positions);

  // The pose to show at `now_s`, not before an earlier `now_s`. `positions` is
  // left alone while the state is kEmpty.
  LiveStatus Sample(double now_s, VectorView positions);

  // The next frame is a first one, by other clocks.
  void Reset();

  // All that later samples depend on; what they count as late and what is
  // counted begin anew. See StateNumbers.
  void Exchange(StateNumbers& state);
  // What the number of the next frame may be.
  int64_t next_number() const { return newest_number_ + 1; }

  int64_t out_of_order_count() const { return out_of_order_count_; }
  // Frames that came after they should have been shown.
  int64_t late_count() const { return late_count_; }
  const ClockOffset& offset() const { return offset_; }

 private:
  struct Slot {
    int64_t sequence_number = -1;
    double capture_s = 0;
  };

  LiveClock(std::shared_ptr<const Skeleton> skeleton, LiveClockOptions options);
  int At(int index) const { return (first_ + index) % options_.capacity; }
  void PopFront();
  void ExchangePose(VectorView positions, StateNumbers& state);
  // Whether a frame should have come `beyond_s` after the last.
  bool IsMissing(double beyond_s) const;
  // The motion of the last two frames, `beyond_s` after the last.
  void Extrapolate(double beyond_s, VectorView positions);
  LiveStatus ShowLate(double beyond_s, VectorView positions);
  void FadeError(double now_s, bool is_missing, VectorView positions);

  std::shared_ptr<const Skeleton> skeleton_;
  LiveClockOptions options_;
  ClockOffset offset_;
  // A ring: frame i is slots_[At(i)] and poses_.col(At(i)).
  std::vector<Slot> slots_;
  Eigen::MatrixXd poses_;
  int first_ = 0;
  int size_ = 0;
  int64_t newest_number_ = -1;
  double newest_capture_s_ = 0;
  bool has_frame_ = false;
  int64_t out_of_order_count_ = 0;
  int64_t late_count_ = 0;
  // Tangent: from the pose by the frames to the one last shown, when frames
  // came again at `error_s_`.
  Eigen::VectorXd error_;
  Eigen::VectorXd change_;
  Eigen::VectorXd shown_;
  double error_s_ = 0;
  double shown_media_s_ = -INFINITY;
  bool was_missing_ = false;
  bool is_fading_ = false;
};

}  // namespace gelenk

#endif  // GELENK_MOTION_LIVE_CLOCK_H_
