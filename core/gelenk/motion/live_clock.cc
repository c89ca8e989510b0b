#include "gelenk/motion/live_clock.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/number_check.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

// At least two frames tell a motion.
constexpr int kMinCapacity = 2;
constexpr int kMaxCapacity = 4096;

// Spacings of frames after which the next one is missing; less is jitter.
constexpr double kMissing = 1.5;

// Times since 1970 in double are exact to a quarter of this; a frame that is
// due within it is due.
constexpr double kTimeRounding_s = 1e-6;

// From 0 to 1 with no speed at the ends.
double SmoothStep(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

absl::Status Check(const Skeleton& skeleton, LiveClockOptions& options) {
  Violations violations;
  CheckNotNegative("delay_s", options.delay_s, violations);
  CheckPositive("window_s", options.window_s, violations);
  CheckPositive("max_extrapolation_s", options.max_extrapolation_s, violations);
  CheckPositive("ease_s", options.ease_s, violations);
  if (options.capacity < kMinCapacity || options.capacity > kMaxCapacity) {
    violations.Add("capacity",
                   absl::StrCat("want ", kMinCapacity, " to ", kMaxCapacity,
                                ", got ", options.capacity));
  }
  if (options.rest.size() > 0) {
    violations.AddStatus("rest", CheckPositions(skeleton, options.rest));
  }
  return violations.ToStatus();
}

}  // namespace

ClockOffset::ClockOffset(double window_s) : slot_s_(window_s / (kSlots - 1)) {
  std::fill_n(minima_s_, kSlots, 0);
  std::fill_n(slots_, kSlots, 0);
}

void ClockOffset::Note(double capture_s, double arrival_s) {
  const double offset_s = arrival_s - capture_s;
  const int64_t slot = static_cast<int64_t>(std::floor(arrival_s / slot_s_));
  const int place = static_cast<int>(((slot % kSlots) + kSlots) % kSlots);
  if (!has_any_) {
    std::fill_n(minima_s_, kSlots, offset_s);
    std::fill_n(slots_, kSlots, slot);
    newest_slot_ = slot;
    has_any_ = true;
    return;
  }
  if (slot < newest_slot_ - kSlots) return;
  newest_slot_ = std::max(newest_slot_, slot);
  if (slots_[place] != slot) {
    slots_[place] = slot;
    minima_s_[place] = offset_s;
  }
  minima_s_[place] = std::min(minima_s_[place], offset_s);
}

std::optional<double> ClockOffset::offset_s() const {
  if (!has_any_) return std::nullopt;
  double minimum_s = INFINITY;
  for (int i = 0; i < kSlots; ++i) {
    if (slots_[i] <= newest_slot_ - kSlots) continue;
    minimum_s = std::min(minimum_s, minima_s_[i]);
  }
  return minimum_s;
}

absl::StatusOr<LiveClock> LiveClock::Create(
    std::shared_ptr<const Skeleton> skeleton, LiveClockOptions options) {
  if (absl::Status status = Check(*skeleton, options); !status.ok()) {
    return status;
  }
  return LiveClock(std::move(skeleton), std::move(options));
}

LiveClock::LiveClock(std::shared_ptr<const Skeleton> skeleton,
                     LiveClockOptions options)
    : skeleton_(std::move(skeleton)),
      options_(std::move(options)),
      offset_(options_.window_s),
      slots_(options_.capacity),
      poses_(skeleton_->position_count(), options_.capacity),
      error_(Eigen::VectorXd::Zero(skeleton_->velocity_count())),
      change_(error_),
      shown_(skeleton_->rest_positions()) {}

void ClockOffset::Exchange(StateNumbers& state) {
  state.Flag(has_any_);
  if (!has_any_) return;
  const auto exchange_number = [&state](int64_t& number) {
    auto value = static_cast<double>(number);
    state.Number(value);
    number = static_cast<int64_t>(value);
  };
  for (int i = 0; i < kSlots; ++i) {
    state.Number(minima_s_[i]);
    exchange_number(slots_[i]);
  }
  exchange_number(newest_slot_);
}

void LiveClock::Reset() {
  offset_ = ClockOffset(options_.window_s);
  first_ = 0;
  size_ = 0;
  newest_number_ = -1;
  has_frame_ = false;
  shown_media_s_ = -INFINITY;
  was_missing_ = false;
  is_fading_ = false;
}

void LiveClock::Exchange(StateNumbers& state) {
  state.Flag(has_frame_);
  if (!has_frame_) return;
  offset_.Exchange(state);
  state.Count(size_, 1, options_.capacity);
  if (!state.ok()) return;
  if (state.is_reading()) first_ = 0;
  for (int i = 0; i < size_; ++i) {
    Slot& slot = slots_[At(i)];
    // Numbers tell nothing but the order.
    if (state.is_reading()) slot.sequence_number = i;
    state.Number(slot.capture_s);
    ExchangePose(poses_.col(At(i)), state);
  }
  if (state.is_reading()) newest_number_ = size_ - 1;
  state.Number(newest_capture_s_);
  bool has_shown = shown_media_s_ > -INFINITY;
  state.Flag(has_shown);
  if (has_shown) {
    if (state.is_reading()) shown_media_s_ = 0;
    state.Number(shown_media_s_);
  }
  state.Flag(was_missing_);
  state.Flag(is_fading_);
  if (was_missing_) ExchangePose(shown_, state);
  if (!is_fading_) return;
  state.Numbers(error_);
  state.Number(error_s_);
}

void LiveClock::ExchangePose(VectorView positions, StateNumbers& state) {
  state.Numbers(positions);
  if (!state.is_reading() || !state.ok()) return;
  const absl::Status status = CheckPositions(*skeleton_, positions);
  if (!status.ok()) state.Refuse(status.message());
}

void LiveClock::PopFront() {
  first_ = At(1);
  --size_;
}

bool LiveClock::Push(int64_t sequence_number, double capture_s,
                     double arrival_s, const ConstVectorView& positions) {
  const bool is_in_order = !has_frame_ || (sequence_number > newest_number_ &&
                                           capture_s > newest_capture_s_);
  if (!is_in_order || !std::isfinite(capture_s) || !std::isfinite(arrival_s)) {
    ++out_of_order_count_;
    return false;
  }
  offset_.Note(capture_s, arrival_s);
  if (has_frame_ && arrival_s - *offset_.offset_s() - options_.delay_s >
                        capture_s + kTimeRounding_s) {
    ++late_count_;
  }
  has_frame_ = true;
  newest_number_ = sequence_number;
  newest_capture_s_ = capture_s;
  if (size_ == options_.capacity) PopFront();
  slots_[At(size_)] = {sequence_number, capture_s};
  poses_.col(At(size_)) = positions;
  ++size_;
  return true;
}

bool LiveClock::IsMissing(double beyond_s) const {
  if (size_ < 2) return true;
  const double frame_s =
      slots_[At(size_ - 1)].capture_s - slots_[At(size_ - 2)].capture_s;
  return beyond_s > kMissing * frame_s;
}

void LiveClock::Extrapolate(double beyond_s, VectorView positions) {
  const int last = At(size_ - 1);
  positions = poses_.col(last);
  if (size_ < 2) return;
  const int before = At(size_ - 2);
  const double frame_s = slots_[last].capture_s - slots_[before].capture_s;
  // The speed falls to zero at the limit: half of the way it would have gone.
  const double limit_s = options_.max_extrapolation_s;
  const double t = std::min(beyond_s, limit_s);
  const double effective_s = t - t * t / (2 * limit_s);
  Difference(*skeleton_, poses_.col(before), poses_.col(last), change_);
  change_ *= effective_s / frame_s;
  Integrate(*skeleton_, poses_.col(last), change_, positions);
}

LiveStatus LiveClock::ShowLate(double beyond_s, VectorView positions) {
  LiveStatus status;
  status.sequence_number = slots_[At(size_ - 1)].sequence_number;
  switch (options_.late_policy) {
    case LatePolicy::kHold:
      positions = poses_.col(At(size_ - 1));
      status.is_settled = true;
      status.state = IsMissing(beyond_s) ? LiveStatus::State::kHolding
                                         : LiveStatus::State::kPlaying;
      return status;
    case LatePolicy::kDrop:
      if (IsMissing(beyond_s)) {
        status.is_settled = true;
        return status;
      }
      positions = poses_.col(At(size_ - 1));
      status.state = LiveStatus::State::kPlaying;
      return status;
    case LatePolicy::kExtrapolate:
      break;
  }
  Extrapolate(beyond_s, positions);
  const double easing_s = beyond_s - options_.max_extrapolation_s;
  if (easing_s <= 0) {
    status.state = LiveStatus::State::kExtrapolating;
    return status;
  }
  status.state = LiveStatus::State::kEasing;
  status.is_settled = options_.rest.size() == 0 || easing_s >= options_.ease_s;
  if (options_.rest.size() > 0) {
    Difference(*skeleton_, positions, options_.rest, change_);
    if (options_.keeps_root) {
      change_.head(VelocityCount(skeleton_->joint(0).type)).setZero();
    }
    change_ *= SmoothStep(easing_s / options_.ease_s);
    Integrate(*skeleton_, positions, change_, positions);
  }
  return status;
}

// What was shown last is continuous with what is shown next.
void LiveClock::FadeError(double now_s, bool is_missing, VectorView positions) {
  if (is_missing) {
    was_missing_ = true;
    is_fading_ = false;
    return;
  }
  if (was_missing_) {
    was_missing_ = false;
    is_fading_ = true;
    error_s_ = now_s;
    Difference(*skeleton_, positions, shown_, error_);
  }
  if (!is_fading_) return;
  const double left = 1 - SmoothStep((now_s - error_s_) / options_.ease_s);
  if (left <= 0) {
    is_fading_ = false;
    return;
  }
  change_ = left * error_;
  Integrate(*skeleton_, positions, change_, positions);
}

LiveStatus LiveClock::Sample(double now_s, VectorView positions) {
  LiveStatus status;
  if (!has_frame_) return status;
  double media_s = now_s - *offset_.offset_s() - options_.delay_s;
  // A faster frame moves the offset; what is shown does not run backwards.
  media_s = std::max(media_s, shown_media_s_);
  if (size_ > 0 && slots_[At(0)].capture_s <= media_s) shown_media_s_ = media_s;
  // Two frames at or before stay, for the speed.
  const double due_s = media_s + kTimeRounding_s;
  while (size_ > 2 && slots_[At(2)].capture_s <= due_s) PopFront();
  int index = 0;
  while (index + 1 < size_ && slots_[At(index + 1)].capture_s <= due_s) {
    ++index;
  }
  const Slot& before = slots_[At(index)];
  const bool is_waiting = due_s < before.capture_s;
  const bool is_last = index + 1 == size_;
  bool is_missing = false;
  if (is_waiting) {
    positions = poses_.col(At(index));
    status.state = LiveStatus::State::kWaiting;
  } else if (media_s <= before.capture_s) {
    positions = poses_.col(At(index));
    status.state = LiveStatus::State::kPlaying;
  } else if (!is_last) {
    const Slot& after = slots_[At(index + 1)];
    Difference(*skeleton_, poses_.col(At(index)), poses_.col(At(index + 1)),
               change_);
    change_ *=
        (media_s - before.capture_s) / (after.capture_s - before.capture_s);
    Integrate(*skeleton_, poses_.col(At(index)), change_, positions);
    status.state = LiveStatus::State::kPlaying;
  } else {
    status = ShowLate(media_s - before.capture_s, positions);
    is_missing = options_.late_policy == LatePolicy::kExtrapolate &&
                 IsMissing(media_s - before.capture_s);
  }
  status.sequence_number = before.sequence_number;
  status.age_s = now_s - *offset_.offset_s() - before.capture_s;
  if (status.state == LiveStatus::State::kEmpty) return status;
  FadeError(now_s, is_missing, positions);
  shown_ = positions;
  return status;
}

}  // namespace gelenk
