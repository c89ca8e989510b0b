#include "server/session/frame_conditioning.h"

#include <utility>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"

namespace gelenk::server {
namespace {

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

absl::Status FrameConditioning::CheckInTime(const InputFrame& frame) const {
  if (!filled_until_ || !frame.capture_time ||
      *frame.capture_time > *filled_until_) {
    return absl::OkStatus();
  }
  return absl::OutOfRangeError(
      absl::StrCat("capture_time: ", absl::FormatDuration(*frame.capture_time),
                   " is late: the session was filled up to ",
                   absl::FormatDuration(*filled_until_)));
}

absl::Status FrameConditioning::CheckFrame(const InputFrame& frame) const {
  Violations violations;
  if (!frame.capture_time) {
    violations.Add("capture_time", "is needed for the session's conditioning");
  } else if (capture_time_ && *frame.capture_time <= *capture_time_) {
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
  capture_time_ = frame.capture_time;
  if (frame.is_fill) filled_until_ = capture_time_;
  arrival_ = arrival;
  if (IsMissing(frame)) return;
  if (is_of_targets()) {
    for (const GoalUpdate& update : frame.updates) {
      if (update.target) rig_->Put(update.goal_index, *update.target, newest_);
    }
  } else {
    newest_ = frame.source_pose;
  }
  conditioner_.Take(absl::ToDoubleSeconds(*capture_time_), SecondsOf(arrival_),
                    newest_);
}

absl::Status FrameConditioning::Sample() {
  status_ = conditioner_.Sample(absl::ToDoubleSeconds(*capture_time_),
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
  capture_time_.reset();
  filled_until_.reset();
}

void FrameConditioning::Exchange(StateNumbers& state) {
  if (state.is_reading()) {
    capture_time_.reset();
    filled_until_.reset();
  }
  conditioner_.Exchange(state);
  if (!is_of_targets()) return;
  state.Numbers(newest_);
  if (!state.is_reading() || !state.ok()) return;
  const absl::Status status = CheckPositions(*rig_->skeleton(), newest_);
  if (!status.ok()) state.Refuse(status.message());
}

}  // namespace gelenk::server
