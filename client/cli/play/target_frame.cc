#include "client/cli/play/target_frame.h"

#include <type_traits>
#include <variant>

#include "absl/strings/str_format.h"
#include "client/cli/play/clip_goals.h"
#include "convert/duration.h"
#include "convert/geometry.h"
#include "convert/goal.h"

namespace gelenk::cli {
namespace {

// A command that was killed leaves its session behind for no longer.
constexpr int kIdleSeconds = 60;

void SetTarget(const GoalTarget& target, v1::GoalTarget* proto) {
  if (const auto* position = std::get_if<Eigen::Vector3d>(&target)) {
    convert::ToProto(*position, proto->mutable_world_position());
  } else if (const auto* turn = std::get_if<Eigen::Quaterniond>(&target)) {
    convert::ToProto(*turn, proto->mutable_world_rotation());
  } else {
    convert::ToProto(std::get<RigidTransform>(target),
                     proto->mutable_world_pose());
  }
}

SolveOutcome OutcomeOf(v1::SolveReport::Outcome outcome) {
  switch (outcome) {
    case v1::SolveReport::OUTCOME_CONVERGED:
      return SolveOutcome::kConverged;
    case v1::SolveReport::OUTCOME_UNREACHABLE:
      return SolveOutcome::kUnreachable;
    case v1::SolveReport::OUTCOME_STALLED_AT_LIMITS:
      return SolveOutcome::kStalledAtLimits;
    default:
      // Of a service newer than this: it did not say that it converged.
      return SolveOutcome::kIterationLimit;
  }
}

}  // namespace

v1::TargetFrame TargetFrameWriter::Write(int frame) {
  ForwardKinematics(*playback_.skeleton, playback_.clip_poses.col(frame),
                    world_from_joints_);
  TargetsAt(*playback_.skeleton, playback_.goals, world_from_joints_, targets_);
  v1::TargetFrame message;
  message.set_sequence_number(frame + 1);
  convert::ToProto(playback_.frame_time * frame,
                   message.mutable_capture_time());
  for (size_t i = 0; i < targets_.size(); ++i) {
    v1::GoalTarget* target = message.add_targets();
    target->set_goal_index(static_cast<int>(i));
    SetTarget(targets_[i], target);
  }
  return message;
}

v1::Session SessionFor(const Playback& playback) {
  v1::Session session;
  convert::ToProto(playback.goals, session.mutable_goals());
  SetTolerance(playback.tolerance, session.mutable_solver_options());
  session.mutable_idle_ttl()->set_seconds(kIdleSeconds);
  return session;
}

absl::Status TakeAnswer(const v1::PoseFrame& message, Playback* playback) {
  const int64_t frame = message.sequence_number() - 1;
  const int position_count = playback->skeleton->position_count();
  const bool fits = frame >= 0 && frame < playback->frame_count() &&
                    message.pose().positions_size() == position_count;
  if (!fits && message.status().code() == 0) {
    return absl::InternalError(absl::StrFormat(
        "the service answered frame %d with a pose of %d numbers, want %d",
        frame, message.pose().positions_size(), position_count));
  }
  if (frame < 0 || frame >= playback->frame_count()) return absl::OkStatus();
  Answer& answer = playback->answers[frame];
  if (message.status().code() != 0) {
    answer.error = message.status().message();
    return absl::OkStatus();
  }
  const v1::SolveReport& report = message.report();
  answer.answered = true;
  answer.outcome = OutcomeOf(report.outcome());
  answer.position_errors_m.assign(report.position_errors_m().begin(),
                                  report.position_errors_m().end());
  answer.rotation_errors_rad.assign(report.rotation_errors_rad().begin(),
                                    report.rotation_errors_rad().end());
  answer.iteration_count = report.iteration_count();
  answer.restart_count = report.restart_count();
  answer.merged_frame_count = message.merged_frame_count();
  answer.solve_duration = convert::FromProto(report.solve_duration());
  playback->answered_poses.col(frame) = Eigen::Map<const Eigen::VectorXd>(
      message.pose().positions().data(), position_count);
  return absl::OkStatus();
}

}  // namespace gelenk::cli
