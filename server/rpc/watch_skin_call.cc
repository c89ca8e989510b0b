#include "server/rpc/watch_skin_call.h"

#include <chrono>
#include <utility>

#include "absl/time/clock.h"
#include "gelenk/base/violations.h"
#include "server/rpc/skin_message.h"
#include "server/rpc/status.h"
#include "server/rpc/watch_interval.h"

namespace gelenk::server {
namespace {

// A version that no session has: any pose is newer.
constexpr uint64_t kNothingSeen = ~uint64_t{0};

}  // namespace

void WatchSkinCall::Start(v1::SkinService::AsyncService* service,
                          ServiceState* state, IoThread* thread) {
  new WatchSkinCall(service, state, thread);
}

WatchSkinCall::WatchSkinCall(v1::SkinService::AsyncService* service,
                             ServiceState* state, IoThread* thread)
    : service_(service), state_(state), thread_(thread), count_(*thread) {
  grpc::ServerCompletionQueue* queue = thread_->queue();
  context_.AsyncNotifyWhenDone(cancelled_.tag());
  service_->RequestWatchSkin(&context_, &stream_, queue, queue, started_.tag());
}

void WatchSkinCall::OnStarted(bool ok) {
  if (!ok) {  // the server is shutting down; `cancelled_` never comes
    delete this;
    return;
  }
  Start(service_, state_, thread_);
  place_ = std::make_unique<LimitedPlace>(state_->streams,
                                          state_->options.limits.max_streams);
  if (!place_->granted()) {
    return Leave(absl::ResourceExhaustedError("too many streams are open"));
  }
  Read();
}

void WatchSkinCall::Read() {
  reading_ = true;
  stream_.Read(&request_, read_.tag());
}

void WatchSkinCall::OnRead(bool ok) {
  reading_ = false;
  if (!ok || leaving_) {
    // Half-closed, which is how a viewer leaves.
    Leave(absl::OkStatus());
    return DeleteIfDone();
  }
  if (absl::Status status = Take(request_); !status.ok()) return Leave(status);
  Read();
  // A keyframe that is asked for does not wait for the next pose.
  if (step_ == Step::kWaiting) {
    if (keyframe_due_) alarm_.Cancel();
  } else if (step_ == Step::kNone) {
    Look();
  }
}

absl::Status WatchSkinCall::Take(const v1::WatchSkinRequest& request) {
  const bool is_first = frames_ == nullptr;
  if (request.has_start() != is_first) {
    Violations violations;
    violations.Add("start", "the first message holds it, and only the first");
    return violations.ToStatus();
  }
  if (is_first) return Open(request.start());
  keyframe_due_ = keyframe_due_ || request.request_keyframe();
  return absl::OkStatus();
}

absl::Status WatchSkinCall::Open(const v1::WatchSkinRequest::Start& start) {
  absl::StatusOr<RevisionedName> name =
      ParseRevisionName("start.name", kSkins, start.name());
  if (!name.ok()) return name.status();
  skin_name_ = *std::move(name);
  absl::StatusOr<StoredSkin> stored =
      state_->skins.Find(kDefaultTenant, skin_name_.name, skin_name_.revision);
  if (!stored.ok()) return stored.status();
  absl::StatusOr<std::shared_ptr<Session>> session =
      FindSessionOf(*state_, *stored, "start.session", start.session());
  if (!session.ok()) return session.status();
  session_ = *std::move(session);
  interval_ = WatchInterval(start);
  frame_options_ = {start.encoding(), start.keyframe_interval(),
                    start.include_warnings()};
  last_write_ = absl::Now();
  Violations violations;
  violations.AddStatus("start", Show(*std::move(stored)));
  return violations.ToStatus();
}

absl::Status WatchSkinCall::Show(StoredSkin stored) {
  absl::StatusOr<std::unique_ptr<SkinFrames>> frames = SkinFrames::Create(
      std::move(stored), frame_options_, state_->PartRunner());
  if (!frames.ok()) return frames.status();
  frames_ = *std::move(frames);
  layout_due_ = true;
  version_ = kNothingSeen;
  return absl::OkStatus();
}

void WatchSkinCall::Look() {
  if (leaving_) return FinishIfFree();
  response_.Clear();
  if (absl::Status ended = session_->ended(); !ended.ok()) {
    return WriteEnd(ended);
  }
  absl::StatusOr<StoredSkin> stored =
      state_->skins.Find(kDefaultTenant, skin_name_.name, skin_name_.revision);
  if (!stored.ok()) return WriteEnd(stored.status());
  if (stored->revision.skin != frames_->stored().revision.skin) {
    if (absl::Status status = Show(*std::move(stored)); !status.ok()) {
      return WriteEnd(status);
    }
  }
  if (state_->draining && !said_draining_) {
    said_draining_ = true;
    return WriteEvent(v1::StreamEvent::KIND_DRAINING);
  }
  if (state_->closing) {
    return Leave(absl::UnavailableError("the server's drain time is over"));
  }
  if (keyframe_due_) {
    keyframe_due_ = false;
    frames_->RequestKeyframe();
    version_ = kNothingSeen;
  }
  if (layout_due_ ||
      session_->CopyIfNewer(version_, positions_, world_from_skeleton_,
                            sequence_number_)) {
    return Make();
  }
  const absl::Time now = absl::Now();
  if (now - last_write_ > state_->options.heartbeat) {
    return WriteEvent(v1::StreamEvent::KIND_HEARTBEAT);
  }
  WaitUntil(now + interval_);
}

void WatchSkinCall::WriteEnd(const absl::Status& why) {
  leaving_ = true;
  leave_status_ = why;
  ToProto(why, response_.mutable_event()->mutable_status());
  WriteEvent(v1::StreamEvent::KIND_DETACHED);
}

void WatchSkinCall::WriteEvent(v1::StreamEvent::Kind kind) {
  response_.mutable_event()->set_kind(kind);
  Write();
}

void WatchSkinCall::Make() {
  step_ = Step::kMaking;
  const bool taken = state_->workers.Submit([this](IkSolver&) {
    if (layout_due_) {
      frames_->FillLayout(response_.mutable_layout());
    } else {
      response_.mutable_frame()->set_sequence_number(sequence_number_);
      frames_->Deform(positions_, world_from_skeleton_,
                      response_.mutable_frame());
    }
    alarm_.Set(thread_->queue(), std::chrono::system_clock::now(), made_.tag());
  });
  if (taken) return;
  // The workers are busy: this frame is skipped.
  version_ = kNothingSeen;
  WaitUntil(absl::Now() + interval_);
}

void WatchSkinCall::OnMade(bool) {
  step_ = Step::kNone;
  if (leaving_) return FinishIfFree();
  Write();
}

void WatchSkinCall::Write() {
  last_write_ = absl::Now();
  step_ = Step::kWriting;
  stream_.Write(response_, written_.tag());
}

void WatchSkinCall::OnWritten(bool ok) {
  step_ = Step::kNone;
  if (!ok) Leave(absl::CancelledError("the viewer is gone"));
  if (leaving_) return FinishIfFree();
  if (!response_.has_layout()) return WaitUntil(last_write_ + interval_);
  // The frame is right behind.
  layout_due_ = false;
  Look();
}

void WatchSkinCall::WaitUntil(absl::Time time) {
  step_ = Step::kWaiting;
  alarm_.Set(thread_->queue(), absl::ToChronoTime(time), alarmed_.tag());
}

void WatchSkinCall::OnAlarm(bool) {
  step_ = Step::kNone;
  Look();
}

void WatchSkinCall::OnCancelled(bool) {
  done_ = true;
  Leave(absl::CancelledError("the viewer is gone"));
  DeleteIfDone();
}

void WatchSkinCall::Leave(const absl::Status& status) {
  if (!leaving_) leave_status_ = status;
  leaving_ = true;
  if (step_ == Step::kWaiting) {
    alarm_.Cancel();
  } else {
    FinishIfFree();
  }
}

void WatchSkinCall::FinishIfFree() {
  if (finishing_ || step_ != Step::kNone) return;
  finishing_ = true;
  stream_.Finish(ToGrpc(leave_status_), finished_.tag());
}

void WatchSkinCall::OnFinished(bool) {
  finished_call_ = true;
  DeleteIfDone();
}

void WatchSkinCall::DeleteIfDone() {
  if (finished_call_ && done_ && !reading_) delete this;
}

}  // namespace gelenk::server
