#include "gelenk/retarget/live_retargeter.h"

#include <cmath>
#include <utility>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

constexpr double kMaxFrameTime_s = Retargeter::kMaxFrameTime_s;
// A giant's way over a doll's.
constexpr double kMaxRootScale = 1000;

void CheckRange(absl::string_view field, double value, double most,
                Violations& violations) {
  if (value > 0 && value <= most) return;
  violations.Add(field, absl::StrFormat("want more than 0 and at most %g, "
                                        "got %g",
                                        most, value));
}

}  // namespace

absl::StatusOr<std::unique_ptr<LiveRetargeter>> LiveRetargeter::Create(
    LiveRetargetSpec spec) {
  Violations violations;
  CheckRange("frame_time_s", spec.frame_time_s, kMaxFrameTime_s, violations);
  if (spec.options.root_scale) {
    CheckRange("options.root_scale", *spec.options.root_scale, kMaxRootScale,
               violations);
  }
  std::unique_ptr<TrackerBody> trackers;
  if (spec.trackers) {
    absl::StatusOr<std::unique_ptr<TrackerBody>> body = TrackerBody::Create(
        spec.trackers->height_m, spec.options.instruction_set);
    if (body.ok()) {
      trackers = *std::move(body);
      spec.source = trackers->model();
      if (spec.trackers->t_pose) trackers->Calibrate(*spec.trackers->t_pose);
    } else {
      violations.AddStatus("trackers", body.status());
    }
  }
  if (!violations.empty()) return violations.ToStatus();
  absl::StatusOr<std::unique_ptr<Retargeter>> retargeter =
      Retargeter::Create(spec.source, spec.target, spec.options);
  if (!retargeter.ok()) return retargeter.status();
  return absl::WrapUnique(new LiveRetargeter(
      std::move(spec), std::move(trackers), *std::move(retargeter)));
}

LiveRetargeter::LiveRetargeter(LiveRetargetSpec spec,
                               std::unique_ptr<TrackerBody> trackers,
                               std::unique_ptr<Retargeter> retargeter)
    : spec_(std::move(spec)),
      trackers_(std::move(trackers)),
      retargeter_(std::move(retargeter)) {}

absl::Status LiveRetargeter::CheckPose(VectorView source_positions) const {
  return CheckPositions(*source().skeleton, source_positions);
}

absl::Status LiveRetargeter::CheckTime(
    std::optional<absl::Duration> capture_time) const {
  if (!capture_time || !newest_ || *capture_time > *newest_) {
    return absl::OkStatus();
  }
  Violations violations;
  violations.Add("capture_time",
                 absl::StrCat("want after ", absl::FormatDuration(*newest_),
                              ", got ", absl::FormatDuration(*capture_time)));
  return violations.ToStatus();
}

void LiveRetargeter::NoteFrame(std::optional<absl::Duration> capture_time) {
  newest_ = capture_time;
  ++frame_count_;
}

double LiveRetargeter::NextFrameTime() {
  const int count = std::exchange(frame_count_, 0);
  const std::optional<absl::Duration> before = std::exchange(stepped_, newest_);
  const double dt_s = before && newest_
                          ? absl::ToDoubleSeconds(*newest_ - *before)
                          : count * spec_.frame_time_s;
  if (dt_s > 0 && dt_s <= kMaxFrameTime_s) return dt_s;
  // Another clock, or a pause: neither is motion.
  retargeter_->Reset();
  if (trackers_ != nullptr) trackers_->Reset();
  return spec_.frame_time_s;
}

// What is checked cannot fail.
void LiveRetargeter::Step(const ConstVectorView& source_positions) {
  retargeter_->Retarget(source_positions, NextFrameTime()).IgnoreError();
}

void LiveRetargeter::Step(const TrackerFrame& trackers) {
  const double dt_s = NextFrameTime();
  if (!trackers_->Update(trackers, dt_s).ok()) return;
  retargeter_->Retarget(trackers_->positions(), dt_s).IgnoreError();
}

void LiveRetargeter::Reset() {
  retargeter_->Reset();
  if (trackers_ != nullptr) trackers_->Reset();
  newest_.reset();
  stepped_.reset();
  frame_count_ = 0;
}

void LiveRetargeter::Exchange(StateNumbers& state) {
  state.Time(stepped_);
  retargeter_->Exchange(state);
  if (trackers_ != nullptr) trackers_->Exchange(state);
  if (!state.is_reading()) return;
  newest_ = stepped_;
  frame_count_ = 0;
}

size_t LiveRetargeter::ByteSize() const {
  return sizeof(*this) + sizeof(Retargeter) +
         (trackers_ != nullptr ? sizeof(TrackerBody) : 0) +
         4 * positions().size() * sizeof(double);
}

}  // namespace gelenk
