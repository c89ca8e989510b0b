#include "server/session/frame_conditioning.h"

#include <algorithm>
#include <utility>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"

namespace gelenk::server {
namespace {

// Moments that follow on one another are so far apart, and whole multiples of
// it, which messages carry exactly.
constexpr absl::Duration kTimeStep = absl::Microseconds(1);

double SecondsOf(absl::Time time) {
  return absl::ToDoubleSeconds(time - absl::UnixEpoch());
}

}  // namespace

absl::StatusOr<std::unique_ptr<FrameConditioning>> FrameConditioning::OfPoses(
    const ConditioningOptions& options,
    std::shared_ptr<const Skeleton> skeleton) {
  const Eigen::VectorXd rest = skeleton->rest_positions();
  absl::StatusOr<FrameConditioner> conditioner =
      FrameConditioner::Create(std::move(skeleton), options, rest);
  if (!conditioner.ok()) return conditioner.status();
  return absl::WrapUnique(
      new FrameConditioning(*std::move(conditioner), std::nullopt, rest));
}

absl::StatusOr<std::unique_ptr<FrameConditioning>> FrameConditioning::OfTargets(
    const ConditioningOptions& options, absl::Span<const Goal> goals) {
  TargetRig rig(static_cast<int>(goals.size()));
  absl::StatusOr<FrameConditioner> conditioner =
      FrameConditioner::Create(rig.skeleton(), options);
  if (!conditioner.ok()) return conditioner.status();
  Eigen::VectorXd newest = rig.PositionsOf(goals);
  return absl::WrapUnique(new FrameConditioning(
      *std::move(conditioner), std::move(rig), std::move(newest)));
}

FrameConditioning::FrameConditioning(FrameConditioner conditioner,
                                     std::optional<TargetRig> rig,
                                     Eigen::VectorXd newest)
    : options_(conditioner.options()),
      conditioner_(std::move(conditioner)),
      rig_(std::move(rig)),
      newest_(std::move(newest)),
      used_(newest_) {}

bool FrameConditioning::IsMissing(const InputFrame& frame) const {
  if (!is_of_targets()) return !frame.has_source_pose;
  for (const GoalUpdate& update : frame.updates) {
    if (update.target) return false;
  }
  return true;
}

absl::Duration FrameConditioning::TimeOf(absl::Time arrival,
                                         double offset_s) const {
  const absl::Duration time =
      absl::Floor(absl::Seconds(SecondsOf(arrival) - offset_s), kTimeStep);
  return motion_time_ ? std::max(time, *motion_time_ + kTimeStep) : time;
}

void FrameConditioning::SetTimes(absl::Time arrival, InputFrame& frame) const {
  const std::optional<double> offset_s = clock_offset_.offset_s();
  if (frame.is_fill) {
    // Just resumed: the clocks of another server tell nothing, so that the
    // motion goes on by its own time.
    if (offset_s) {
      frame.capture_time = TimeOf(arrival, *offset_s);
    } else if (motion_time_) {
      frame.capture_time =
          *motion_time_ + absl::Seconds(options_.fill_interval_s);
    }
  }
  frame.motion_time = frame.capture_time;
  if (frame.is_fill || !frame.capture_time) return;
  if (!fills() || options_.jitter_frames == 0) return;
  const double least_s =
      SecondsOf(arrival) - absl::ToDoubleSeconds(*frame.capture_time);
  frame.motion_time =
      TimeOf(arrival, std::min(least_s, offset_s.value_or(least_s)));
}

absl::Status FrameConditioning::CheckInTime(const InputFrame& frame) const {
  if (!shown_until_ || !frame.capture_time || frame.is_fill ||
      *frame.capture_time > *shown_until_) {
    return absl::OkStatus();
  }
  return absl::OutOfRangeError(
      absl::StrCat("capture_time: ", absl::FormatDuration(*frame.capture_time),
                   " is late: the motion was shown up to ",
                   absl::FormatDuration(*shown_until_), " without it"));
}

absl::Status FrameConditioning::CheckFrame(const InputFrame& frame) const {
  Violations violations;
  if (!frame.capture_time) {
    violations.Add("capture_time", "is needed for the session's conditioning");
  } else if (!frame.is_fill && capture_time_ &&
             *frame.capture_time <= *capture_time_) {
    violations.Add(
        "capture_time",
        absl::StrCat("want after ", absl::FormatDuration(*capture_time_),
                     ", got ", absl::FormatDuration(*frame.capture_time)));
  }
  if (IsMissing(frame) && !conditioner_.has_frame()) {
    violations.Add(is_of_targets() ? "targets" : "source_pose",
                   "is missing, and none came before");
  }
  return violations.ToStatus();
}

void FrameConditioning::Take(const InputFrame& frame, absl::Time arrival) {
  motion_time_ = frame.motion_time;
  arrival_ = arrival;
  if (frame.is_fill) {
    shown_until_ = *motion_time_ - absl::Seconds(options_.delay_s());
    return;
  }
  capture_time_ = frame.capture_time;
  const double capture_s = absl::ToDoubleSeconds(*capture_time_);
  if (fills()) clock_offset_.Note(capture_s, SecondsOf(arrival));
  if (IsMissing(frame)) return;
  if (is_of_targets()) {
    for (const GoalUpdate& update : frame.updates) {
      if (update.target) rig_->Put(update.goal_index, *update.target, newest_);
    }
  } else {
    newest_ = frame.source_pose;
  }
  conditioner_.Take(capture_s, SecondsOf(arrival_), newest_);
}

absl::Status FrameConditioning::Sample() {
  status_ = conditioner_.Sample(absl::ToDoubleSeconds(*motion_time_),
                                SecondsOf(arrival_), used_);
  if (status_.state != LiveStatus::State::kEmpty) return absl::OkStatus();
  return absl::DeadlineExceededError(
      absl::StrFormat("late: no frame came for %.3g s", status_.age_s));
}

absl::Status FrameConditioning::Sample(Eigen::VectorXd& source_positions) {
  if (absl::Status status = Sample(); !status.ok()) return status;
  source_positions = used_;
  return absl::OkStatus();
}

absl::Status FrameConditioning::Sample(IkProblem& problem) {
  // After a patch of the goals none may have come yet.
  if (!conditioner_.has_frame()) return absl::OkStatus();
  if (absl::Status status = Sample(); !status.ok()) return status;
  rig_->Aim(used_, problem);
  return absl::OkStatus();
}

void FrameConditioning::SetGoals(absl::Span<const Goal> goals) {
  TargetRig rig(static_cast<int>(goals.size()));
  // The options have passed before.
  conditioner_ = *FrameConditioner::Create(rig.skeleton(), options());
  newest_ = rig.PositionsOf(goals);
  used_ = newest_;
  rig_ = std::move(rig);
  Reset();
}

void FrameConditioning::Reset() {
  conditioner_.Reset();
  ForgetTimes();
}

void FrameConditioning::ForgetTimes() {
  capture_time_.reset();
  motion_time_.reset();
  shown_until_.reset();
  clock_offset_ = ClockOffset(kClockWindow_s);
}

void FrameConditioning::Exchange(StateNumbers& state) {
  if (state.is_reading()) ForgetTimes();
  conditioner_.Exchange(state);
  if (fills()) {
    state.Time(motion_time_);
    state.Time(shown_until_);
  }
  if (!is_of_targets()) return;
  state.Numbers(newest_);
  if (!state.is_reading() || !state.ok()) return;
  const absl::Status status = CheckPositions(*rig_->skeleton(), newest_);
  if (!status.ok()) state.Refuse(status.message());
}

}  // namespace gelenk::server
