#include "gelenk/motion/frame_conditioner.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

// Frames that are shown one after the other, and some that come at once.
constexpr int kSpareFrames = 4;

absl::Status CheckTimes(const ConditioningOptions& options) {
  Violations violations;
  if (options.jitter_frames < 0 || options.jitter_frames > kMaxJitterFrames) {
    violations.Add("jitter_buffer_frames",
                   absl::StrCat("want 0 to ", kMaxJitterFrames, ", got ",
                                options.jitter_frames));
  }
  if (options.jitter_frames > 0 && !(options.frame_interval_s > 0)) {
    violations.Add("frame_interval",
                   absl::StrCat("want more than 0 s with a jitter buffer, got ",
                                options.frame_interval_s));
  }
  const double fill_s = options.fill_interval_s;
  if (fill_s != 0 &&
      !(fill_s >= kMinFillInterval_s && fill_s <= kMaxFillInterval_s)) {
    violations.Add("fill_interval",
                   absl::StrCat("want ", kMinFillInterval_s, " to ",
                                kMaxFillInterval_s, " s, got ", fill_s));
  }
  return violations.ToStatus();
}

}  // namespace

absl::StatusOr<FrameConditioner> FrameConditioner::Create(
    std::shared_ptr<const Skeleton> skeleton,
    const ConditioningOptions& options, const Eigen::VectorXd& rest) {
  if (absl::Status status = CheckTimes(options); !status.ok()) return status;
  LiveClockOptions clock_options;
  clock_options.delay_s = options.delay_s();
  clock_options.late_policy = options.late_policy;
  clock_options.max_extrapolation_s = options.max_extrapolation_s;
  clock_options.ease_s = options.ease_s;
  clock_options.rest = rest;
  clock_options.keeps_root = true;
  clock_options.capacity = 2 * options.jitter_frames + kSpareFrames;
  Violations violations;
  absl::StatusOr<LiveClock> clock =
      LiveClock::Create(skeleton, std::move(clock_options));
  violations.AddStatus("", clock.status());
  absl::StatusOr<Smoother> smoother =
      Smoother::Create(skeleton, options.smoother);
  violations.AddStatus("", smoother.status());
  if (!violations.empty()) return violations.ToStatus();
  return FrameConditioner(std::move(skeleton), options, *std::move(clock),
                          *std::move(smoother));
}

FrameConditioner::FrameConditioner(std::shared_ptr<const Skeleton> skeleton,
                                   const ConditioningOptions& options,
                                   LiveClock clock, Smoother smoother)
    : skeleton_(std::move(skeleton)),
      options_(options),
      clock_(std::move(clock)),
      smoother_(std::move(smoother)) {}

void FrameConditioner::Take(double capture_s, double arrival_s,
                            const ConstVectorView& positions) {
  clock_.Push(frame_count_++, capture_s,
              options_.jitter_frames > 0 ? arrival_s : capture_s, positions);
}

LiveStatus FrameConditioner::Sample(double capture_s, double arrival_s,
                                    VectorView positions) {
  const double now_s = options_.jitter_frames > 0 ? arrival_s : capture_s;
  const LiveStatus status = clock_.Sample(now_s, positions);
  if (status.state == LiveStatus::State::kEmpty) return status;
  if (options_.smoother.kind != SmootherOptions::Kind::kNone) {
    smoother_.Push(now_s, positions, positions);
  }
  return status;
}

double FrameConditioner::latency_s() const {
  return options_.delay_s() + smoother_.latency_s();
}

void FrameConditioner::Reset() {
  clock_.Reset();
  smoother_.Reset();
  frame_count_ = 0;
}

void FrameConditioner::Exchange(StateNumbers& state) {
  int frame_count = frame_count_ > 0 ? 1 : 0;
  state.Count(frame_count, 0, 1);
  if (frame_count == 0) {
    if (state.is_reading()) Reset();
    return;
  }
  clock_.Exchange(state);
  if (state.is_reading()) frame_count_ = clock_.next_number();
  if (options_.smoother.kind != SmootherOptions::Kind::kNone) {
    smoother_.Exchange(state);
  }
}

}  // namespace gelenk
