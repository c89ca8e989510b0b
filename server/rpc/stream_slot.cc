#include "server/rpc/stream_slot.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "convert/conditioning.h"
#include "convert/duration.h"
#include "convert/geometry.h"
#include "convert/goal.h"
#include "convert/pose.h"
#include "gelenk/base/violations.h"
#include "server/clock.h"
#include "server/rpc/continuation.h"
#include "server/rpc/session_message.h"
#include "server/rpc/status.h"

namespace gelenk::server {
namespace {

absl::Status CheckAttach(const v1::AttachSession& request) {
  Violations violations;
  violations.AddStatus(
      "", CheckResourceName("attach.session", kSessions, request.session()));
  const auto check = [&violations](absl::string_view field, int value) {
    if (value >= 0) return;
    violations.Add(field, absl::StrCat("want 0 or more, got ", value));
  };
  check("attach.slot", request.slot());
  check("attach.report_interval", request.report_interval());
  check("attach.continuation_interval", request.continuation_interval());
  return violations.ToStatus();
}

absl::Status FrameFromProto(const v1::TargetFrame& proto, InputFrame& frame) {
  frame.Clear();
  frame.sequence_number = proto.sequence_number();
  Violations violations;
  for (int i = 0; i < proto.targets_size(); ++i) {
    const v1::GoalTarget& target = proto.targets(i);
    GoalUpdate update;
    update.goal_index = target.goal_index();
    if (target.has_weight()) update.weight = target.weight();
    const bool weight_only =
        target.target_case() == v1::GoalTarget::TARGET_NOT_SET &&
        target.has_weight();
    if (!weight_only) {
      GoalTarget value;
      if (absl::Status status = convert::FromProto(target, &value);
          !status.ok()) {
        violations.AddStatus(absl::StrCat("targets[", i, "]"), status);
        continue;
      }
      update.target = value;
    }
    frame.updates.push_back(update);
  }
  if (proto.has_capture_time()) {
    frame.capture_time = convert::FromProto(proto.capture_time());
  }
  if (proto.has_source_pose()) {
    convert::CopyNumbers(proto.source_pose(), frame.source_pose);
    frame.has_source_pose = true;
  }
  if (proto.has_goal_patch()) {
    frame.patch = [&patch = proto.goal_patch()](absl::Span<const Goal> goals) {
      return convert::Merge(goals, patch);
    };
  }
  if (proto.has_world_from_skeleton()) {
    frame.world_from_skeleton = convert::FromProto(proto.world_from_skeleton());
  }
  return violations.ToStatus();
}

absl::Status CheckAffinity(const Session& session, const Session* neighbour) {
  if (neighbour == nullptr ||
      session.affinity_key() == neighbour->affinity_key()) {
    return absl::OkStatus();
  }
  return absl::FailedPreconditionError(absl::StrCat(
      "attach.session: ", session.name(), " has affinity key \"",
      session.affinity_key(), "\", the stream's sessions another one"));
}

absl::Duration FillIntervalOf(const SessionInput& input) {
  return input.conditioning == nullptr
             ? absl::ZeroDuration()
             : absl::Seconds(input.conditioning->options().fill_interval_s);
}

// Where a client says that it was.
struct ResumePoint {
  Eigen::VectorXd positions;
  int64_t sequence_number = 0;
  std::optional<Continuation> continuation;
};

absl::StatusOr<ResumePoint> ReadResumePoint(const v1::PoseFrame& from,
                                            const Skeleton& skeleton,
                                            InstructionSet level) {
  ResumePoint point;
  absl::StatusOr<Eigen::VectorXd> positions =
      convert::FromProto(skeleton, from.pose());
  if (!positions.ok()) {
    Violations violations;
    violations.AddStatus("resume_from.pose", positions.status());
    return violations.ToStatus();
  }
  point.positions = *std::move(positions);
  point.sequence_number = from.sequence_number();
  if (from.continuation().empty()) return point;
  absl::StatusOr<Continuation> continuation =
      ReadContinuation(from.continuation(), level);
  if (!continuation.ok()) return continuation.status();
  point.continuation = *std::move(continuation);
  return point;
}

absl::Status Resume(Session& session, DriverId driver,
                    const ResumePoint& point) {
  ResumeState state;
  state.positions = point.positions;
  state.sequence_number = point.sequence_number;
  if (point.continuation) {
    state.goals = &point.continuation->goals;
    state.world_from_skeleton = &point.continuation->world_from_skeleton;
    state.motion = &point.continuation->motion;
    if (!point.continuation->memory.empty()) {
      state.memory = &point.continuation->memory;
    }
  }
  return session.Resume(driver, state);
}

// Why going on from `point` is not exact; empty when it is.
std::string InexactBecause(const Session& session, const ResumePoint& point) {
  const FrameConditioning* conditioning = session.input().conditioning.get();
  if (conditioning != nullptr && conditioning->options().jitter_frames > 0) {
    return "not exact: a jitter buffer goes by the time of arrival";
  }
  if (point.continuation) return point.continuation->inexact_because;
  if (session.input().empty()) return "";
  return "not exact: resume_from has no continuation, the motion begins anew";
}

}  // namespace

absl::StatusOr<std::unique_ptr<StreamSlot>> StreamSlot::Attach(
    ServiceState& state, const v1::AttachSession& request,
    const Session* neighbour, absl::Time now, v1::StreamEvent* event) {
  if (absl::Status status = CheckAttach(request); !status.ok()) return status;
  absl::StatusOr<std::shared_ptr<Session>> session =
      state.sessions.Find(kDefaultTenant, request.session(), now);
  if (!session.ok()) return session.status();
  if (absl::Status status = CheckAffinity(**session, neighbour); !status.ok()) {
    return status;
  }
  absl::StatusOr<ResumePoint> point = ResumePoint();
  if (request.has_resume_from()) {
    point = ReadResumePoint(request.resume_from(), (*session)->skeleton(),
                            state.options.instruction_set);
    if (!point.ok()) return point.status();
  }
  const DriverId driver = state.next_driver++;
  if (absl::Status status = (*session)->Claim(driver, request.take_over(), now);
      !status.ok()) {
    return status;
  }
  // From here on the slot gives the session free when something fails.
  std::unique_ptr<StreamSlot> slot(
      new StreamSlot(state, *session, driver, request));
  if (request.has_resume_from()) {
    if (absl::Status status = Resume(**session, driver, *point); !status.ok()) {
      return status;
    }
    // The source may have fallen silent meanwhile.
    slot->schedule_.Begin(now);
  }
  event->set_kind(v1::StreamEvent::KIND_ATTACHED);
  event->set_slot(request.slot());
  slot->newest_number_ = (*session)->sequence_number();
  event->set_sequence_number(slot->newest_number_);
  const std::string inexact =
      request.has_resume_from() ? InexactBecause(**session, *point) : "";
  if (!inexact.empty()) {
    ToProto(absl::FailedPreconditionError(inexact), event->mutable_status());
  }
  return slot;
}

StreamSlot::StreamSlot(const ServiceState& state,
                       std::shared_ptr<Session> session, DriverId driver,
                       const v1::AttachSession& request)
    : session_(std::move(session)),
      driver_(driver),
      level_(state.options.instruction_set),
      slot_(request.slot()),
      every_frame_(request.frame_policy() == v1::FRAME_POLICY_EVERY_FRAME),
      include_joint_frames_(request.include_joint_frames()),
      report_interval_(std::max(1, request.report_interval())),
      continuation_interval_(std::max(1, request.continuation_interval())),
      schedule_(FillIntervalOf(session_->input())) {}

StreamSlot::~StreamSlot() { session_->Release(driver_); }

size_t StreamSlot::answer_bytes() const {
  constexpr size_t kReport = 512;
  const size_t frames =
      include_joint_frames_
          ? 7 * sizeof(float) * session_->skeleton().joint_count()
          : 0;
  return kReport + frames +
         sizeof(double) * session_->skeleton().position_count();
}

absl::Status StreamSlot::Take(const v1::TargetFrame& frame, absl::Time now) {
  if (frame.sequence_number() <= newest_number_) {
    ++out_of_order_count_;
  } else {
    newest_number_ = frame.sequence_number();
  }
  if (absl::Status status = FrameFromProto(frame, input_); !status.ok()) {
    // The number is used up all the same, so that answers stay in order.
    absl::Status numbered =
        session_->Skip(driver_, frame.sequence_number(), now);
    return numbered.ok() ? status : numbered;
  }
  if (absl::Status status = session_->Apply(driver_, input_, now);
      !status.ok()) {
    if (absl::IsOutOfRange(status)) {
      ++out_of_order_count_;
      schedule_.PutOff(now);
    }
    return status;
  }
  schedule_.Begin(now);
  ++taken_;
  sequence_number_ = frame.sequence_number();
  has_capture_time_ = frame.has_capture_time();
  if (has_capture_time_) {
    capture_time_ = frame.capture_time();
    NoteAge(*input_.capture_time, now);
  }
  return absl::OkStatus();
}

void StreamSlot::NoteAge(absl::Duration capture_time, absl::Time arrival) {
  const double capture_s = absl::ToDoubleSeconds(capture_time);
  const double arrival_s = absl::ToDoubleSeconds(arrival - absl::UnixEpoch());
  clock_offset_.Note(capture_s, arrival_s);
  age_s_ = std::max(0.0, arrival_s - capture_s - *clock_offset_.offset_s());
}

absl::Status StreamSlot::Fill(IkSolver& solver, absl::Time now,
                              v1::PoseFrame* answer) {
  schedule_.Stop();
  input_.Clear();
  input_.is_fill = true;
  if (absl::Status status = session_->Apply(driver_, input_, now);
      !status.ok()) {
    return status;
  }
  sequence_number_ = session_->sequence_number();
  has_capture_time_ = true;
  convert::ToProto(*input_.capture_time, &capture_time_);
  age_s_ = 0;
  session_->CopyPositions(positions_before_);
  if (absl::Status status = Solve(solver, now, answer); !status.ok()) {
    return status;
  }
  answer->mutable_timing()->set_filled(true);
  schedule_.Note(
      now, solved_.live->is_settled,
      (solved_.positions - positions_before_).lpNorm<Eigen::Infinity>());
  return absl::OkStatus();
}

absl::Status StreamSlot::Answer(IkSolver& solver, absl::Time read_time,
                                v1::PoseFrame* answer) {
  if (absl::Status status = Solve(solver, read_time, answer); !status.ok()) {
    return status;
  }
  answer->set_merged_frame_count(taken_ - 1);
  taken_ = 0;
  return absl::OkStatus();
}

absl::Status StreamSlot::Solve(IkSolver& solver, absl::Time begin,
                               v1::PoseFrame* answer) {
  const bool whole = answered_ % report_interval_ == 0;
  const absl::Status status = session_->Solve(driver_, solver, whole, solved_);
  // A frame that is late is answered, too; see LatePolicy.
  if (!status.ok() && !absl::IsDeadlineExceeded(status)) return status;
  answer->set_slot(slot_);
  answer->set_sequence_number(sequence_number_);
  if (status.ok()) {
    ReportsToProto(solved_, whole, answer);
    AddExtras(answer);
  } else {
    ToProto(status, answer->mutable_status());
    session_->CopyPositions(solved_.positions);
    solved_.end_time = Now();
  }
  convert::ToProto(solved_.positions, answer->mutable_pose());
  if (has_capture_time_) AddTime(answer);
  convert::ToProto(solved_.end_time - begin, answer->mutable_server_duration());
  ++answered_;
  return absl::OkStatus();
}

void StreamSlot::AddTime(v1::PoseFrame* answer) {
  *answer->mutable_capture_time() = capture_time_;
  v1::FrameTiming* timing = answer->mutable_timing();
  double age_s = age_s_;
  if (solved_.live) {
    timing->set_source(convert::SourceToProto(solved_.live->state));
    convert::ToProto(solved_.latency, timing->mutable_latency());
    // By the captures, what is shown is so much older than the newest frame;
    // with a jitter buffer it is by the arrivals, and all of it.
    const bool by_arrival =
        session_->input().conditioning->options().jitter_frames > 0;
    age_s = solved_.live->age_s + (by_arrival ? 0 : age_s_);
  }
  convert::ToProto(absl::Seconds(age_s), timing->mutable_age());
  timing->set_out_of_order_count(out_of_order_count_);
}

void StreamSlot::AddExtras(v1::PoseFrame* answer) {
  if (include_joint_frames_) {
    ForwardKinematics(session_->skeleton(), solved_.positions,
                      session_->Snapshot().state.world_from_skeleton, frames_);
    convert::ToProto(frames_, answer->mutable_joint_frames());
  }
  if (solved_.needs_continuation && answered_ % continuation_interval_ == 0) {
    answer->set_continuation(WriteContinuation(*session_, level_));
  }
}

void StreamSlot::Refuse(const v1::TargetFrame& frame, const absl::Status& why,
                        v1::PoseFrame* answer) {
  answer->set_slot(slot_);
  answer->set_sequence_number(frame.sequence_number());
  if (frame.has_capture_time()) {
    *answer->mutable_capture_time() = frame.capture_time();
  }
  ToProto(why, answer->mutable_status());
  session_->CopyPositions(solved_.positions);
  convert::ToProto(solved_.positions, answer->mutable_pose());
}

}  // namespace gelenk::server
