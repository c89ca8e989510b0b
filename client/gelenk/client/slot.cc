#include "gelenk/client/slot.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/client/frame_merge.h"
#include "gelenk/client/status.h"

namespace gelenk::client {
namespace {

// A repeated create answers its first result, so one that shall make anew needs
// another id. The contract allows 64 bytes.
std::string NextRequestId(const std::string& request_id, int creation_count) {
  if (creation_count == 0 || request_id.empty()) return request_id;
  return absl::StrCat(request_id.substr(0, 52), "-", creation_count);
}

std::optional<v1::CreateSkeletonRequest> NextRequest(
    const v1::CreateSkeletonRequest& request, int creation_count) {
  if (!request.has_skeleton()) return std::nullopt;
  v1::CreateSkeletonRequest next = request;
  next.set_request_id(NextRequestId(request.request_id(), creation_count));
  return next;
}

absl::Status NewAttempt(absl::string_view reason, const absl::Status& status) {
  return absl::UnavailableError(absl::StrCat(reason, ": ", status.ToString()));
}

}  // namespace

Slot::Slot(int index, SessionSpec spec)
    : index_(index),
      spec_(std::move(spec)),
      phase_(Phase::kAbsent),
      goals_(spec_.session.session()) {
  answered_.set_slot(index_);
}

void Slot::End(absl::Status status) {
  if (phase_ == Phase::kEnded) return;
  phase_ = Phase::kEnded;
  status_ = std::move(status);
  waiting_.clear();
  sent_count_ = 0;
}

void Slot::SetAdopted(SessionSpec spec) {
  spec_ = std::move(spec);
  goals_ = EffectiveGoals(spec_.session.session());
  SetCreated();
}

Creation Slot::NextCreation() {
  Creation creation;
  creation.again = creation_count_ > 0;
  creation.replaces = replace_;
  creation.affinity_key = AffinityKey(spec_);
  creation.skeleton = NextRequest(spec_.skeleton, creation_count_);
  creation.source_skeleton =
      NextRequest(spec_.source_skeleton, creation_count_);
  creation.session = spec_.session;
  creation.session.set_request_id(
      NextRequestId(spec_.session.request_id(), creation_count_));
  if (was_solved_) {
    v1::Session* session = creation.session.mutable_session();
    goals_.Declare(session);
    *session->mutable_pose() = answered_.pose();
  }
  return creation;
}

void Slot::SetCreated() {
  phase_ = Phase::kDetached;
  just_created_ = true;
  replace_ = false;
  ++creation_count_;
}

void Slot::Rewind(StreamStatistics* statistics) {
  if (phase_ == Phase::kEnded) return;
  if (phase_ != Phase::kAbsent) phase_ = Phase::kDetached;
  sent_count_ = 0;
  probing_ = false;
  just_created_ = false;
  if (merges()) MergeWaiting(statistics);
}

void Slot::Attach(v1::AttachSession* request) {
  request->set_session(SessionName(spec_));
  request->set_slot(index_);
  request->set_frame_policy(spec_.frame_policy);
  request->set_include_joint_frames(spec_.include_joint_frames);
  request->set_report_interval(spec_.report_interval);
  request->set_take_over(spec_.take_over && !was_attached_);
  if (was_solved_) *request->mutable_resume_from() = answered_;
  phase_ = Phase::kAttaching;
}

absl::Status Slot::OnAttached(const v1::StreamEvent& event,
                              StreamStatistics* statistics) {
  if (phase_ != Phase::kAttaching) return absl::OkStatus();
  phase_ = Phase::kAttached;
  if (!was_attached_) {
    was_attached_ = true;
    answered_.set_sequence_number(event.sequence_number());
    last_pushed_ = std::max(last_pushed_, event.sequence_number());
    return absl::OkStatus();
  }
  if (event.status().code() != 0) ++statistics->inexact_resumes;
  if (!was_solved_) {
    const bool is_ahead = event.sequence_number() > answered_.sequence_number();
    if (!is_ahead || just_created_) return absl::OkStatus();
    return Replace("all answers so far were lost");
  }
  if (!answered_.continuation().empty()) return absl::OkStatus();
  if (!just_created_ && TracesOfSent().patches) {
    return Replace("the answer to a patch of its goals was lost");
  }
  probing_ = true;
  return absl::OkStatus();
}

absl::Status Slot::Replace(absl::string_view reason) {
  replace_ = true;
  phase_ = Phase::kAbsent;
  return absl::UnavailableError(
      absl::StrCat(SessionName(spec_), " is made anew: ", reason));
}

Slot::Traces Slot::TracesOfSent() const {
  Traces traces;
  for (const WaitingFrame& waiting : waiting_) {
    if (!waiting.was_sent) continue;
    const v1::TargetFrame& frame = waiting.frame;
    traces.patches |= frame.has_goal_patch();
    traces.unsettled.place |= frame.has_world_from_skeleton();
    for (const v1::GoalTarget& target : frame.targets()) {
      traces.unsettled.weights |= target.has_weight();
    }
  }
  return traces;
}

absl::Status Slot::OnDetached(const v1::StreamEvent& event) {
  absl::Status status = FromProto(event.status());
  if (status.ok()) status = absl::AbortedError("detached");
  if (phase_ == Phase::kAttaching && absl::IsNotFound(status)) {
    phase_ = Phase::kAbsent;
    if (!just_created_) return absl::OkStatus();
    return NewAttempt("created, and not found", status);
  }
  if (absl::IsUnavailable(status)) {
    phase_ = Phase::kDetached;
    return NewAttempt(SessionName(spec_), status);
  }
  // Coming back, the driver may be this very stream: the server has not yet
  // noticed that its connection is gone.
  if (phase_ == Phase::kAttaching && was_attached_ &&
      (absl::IsAborted(status) || absl::IsFailedPrecondition(status))) {
    phase_ = Phase::kDetached;
    return NewAttempt(SessionName(spec_), status);
  }
  End(absl::Status(status.code(),
                   absl::StrCat(SessionName(spec_), ": ", status.message())));
  return absl::OkStatus();
}

absl::Status Slot::CheckNumber(int64_t sequence_number) const {
  if (sequence_number > last_pushed_) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("sequence_number: ", sequence_number,
                   " is not above the one before, ", last_pushed_));
}

bool Slot::CanMerge(const v1::TargetFrame& frame) const {
  return merges() && sent_count_ < unanswered_count() &&
         !frame.has_goal_patch();
}

bool Slot::HasRoom(const v1::TargetFrame& frame, int window) const {
  if (!merges()) return unanswered_count() < window;
  // Patches of goals do not merge; this bounds even those.
  return CanMerge(frame) || unanswered_count() < 2 * window;
}

void Slot::Push(v1::TargetFrame frame, SteadyTime now,
                StreamStatistics* statistics) {
  last_pushed_ = frame.sequence_number();
  if (CanMerge(frame) && Merge(frame, &waiting_.back().frame)) {
    waiting_.back().push_time = now;
    ++statistics->merged_frames;
    return;
  }
  waiting_.push_back({std::move(frame), now});
}

void Slot::MergeWaiting(StreamStatistics* statistics) {
  std::deque<WaitingFrame> merged;
  for (WaitingFrame& next : waiting_) {
    if (!merged.empty() && Merge(next.frame, &merged.back().frame)) {
      merged.back().push_time = next.push_time;
      ++statistics->merged_frames;
    } else {
      merged.push_back(std::move(next));
    }
  }
  waiting_ = std::move(merged);
}

int Slot::Send(int max_frames, int window, v1::StreamingSolveRequest* request,
               StreamStatistics* statistics) {
  if (phase_ != Phase::kAttached) return 0;
  if (probing_) window = 1;
  const int end =
      std::min({unanswered_count(), window, sent_count_ + max_frames});
  int count = 0;
  for (; sent_count_ < end; ++sent_count_, ++count) {
    WaitingFrame& waiting = waiting_[sent_count_];
    v1::TargetFrame* frame = request->add_frames();
    *frame = waiting.frame;
    if (probing_) goals_.Complete(TracesOfSent().unsettled, frame);
    ++(waiting.was_sent ? statistics->resent_frames : statistics->sent_frames);
    waiting.was_sent = true;
  }
  return count;
}

bool Slot::Settle(const v1::PoseFrame& answer, SteadyTime now,
                  StreamStatistics* statistics) {
  if (answer.sequence_number() <= answered_.sequence_number()) return false;
  const bool accepted = answer.status().code() == 0;
  while (!waiting_.empty() &&
         waiting_.front().frame.sequence_number() <= answer.sequence_number()) {
    const WaitingFrame& oldest = waiting_.front();
    const bool is_newest =
        oldest.frame.sequence_number() == answer.sequence_number();
    if (accepted || !is_newest) goals_.Apply(oldest.frame);
    if (is_newest) {
      statistics->round_trips.Add(absl::FromChrono(now - oldest.push_time));
    }
    waiting_.pop_front();
    sent_count_ = std::max(0, sent_count_ - 1);
  }
  answered_.set_sequence_number(answer.sequence_number());
  NoteAnswer(answer);
  if (accepted) probing_ = false;
  ++statistics->answered_frames;
  return true;
}

bool Slot::TakeFill(const v1::PoseFrame& answer) {
  if (answer.sequence_number() != answered_.sequence_number()) return false;
  NoteAnswer(answer);
  return true;
}

void Slot::NoteAnswer(const v1::PoseFrame& answer) {
  *answered_.mutable_capture_time() = answer.capture_time();
  if (answer.status().code() != 0) return;
  *answered_.mutable_pose() = answer.pose();
  answered_.set_continuation(answer.continuation());
  was_solved_ = true;
}

}  // namespace gelenk::client
