#include "server/rpc/watch_session_call.h"

#include "absl/time/clock.h"
#include "convert/pose.h"
#include "server/rpc/find_session.h"
#include "server/rpc/session_message.h"
#include "server/rpc/status.h"
#include "server/rpc/watch_interval.h"

namespace gelenk::server {

void WatchSessionCall::Start(v1::SessionService::AsyncService* service,
                             ServiceState* state, IoThread* thread) {
  new WatchSessionCall(service, state, thread);
}

WatchSessionCall::WatchSessionCall(v1::SessionService::AsyncService* service,
                                   ServiceState* state, IoThread* thread)
    : service_(service), state_(state), thread_(thread), count_(*thread) {
  grpc::ServerCompletionQueue* queue = thread_->queue();
  context_.AsyncNotifyWhenDone(cancelled_.tag());
  service_->RequestWatchSession(&context_, &request_, &writer_, queue, queue,
                                started_.tag());
}

void WatchSessionCall::OnStarted(bool ok) {
  if (!ok) {  // the server is shutting down; `cancelled_` never comes
    delete this;
    return;
  }
  Start(service_, state_, thread_);
  if (absl::Status status = Open(); !status.ok()) {
    Finish(status);
    return;
  }
  last_write_ = absl::Now();
  Look();
}

absl::Status WatchSessionCall::Open() {
  place_ = std::make_unique<LimitedPlace>(state_->streams,
                                          state_->options.limits.max_streams);
  if (!place_->granted()) {
    return absl::ResourceExhaustedError("too many streams are open");
  }
  absl::StatusOr<std::shared_ptr<Session>> session =
      FindSession(*state_, "name", request_.name());
  if (!session.ok()) return session.status();
  session_ = *session;
  interval_ = WatchInterval(request_);
  return absl::OkStatus();
}

void WatchSessionCall::Look() {
  response_.Clear();
  const absl::Time now = absl::Now();
  if (const absl::Status ended = session_->ended(); !ended.ok()) {
    said_ended_ = true;
    response_.mutable_event()->set_kind(v1::StreamEvent::KIND_DETACHED);
    ToProto(ended, response_.mutable_event()->mutable_status());
    return Write();
  }
  if (state_->draining && !said_draining_) {
    said_draining_ = true;
    response_.mutable_event()->set_kind(v1::StreamEvent::KIND_DRAINING);
    return Write();
  }
  if (state_->closing) {
    return Finish(absl::UnavailableError("the server's drain time is over"));
  }
  RigidTransform world_from_skeleton;
  int64_t sequence_number = 0;
  if (session_->CopyIfNewer(version_, positions_, world_from_skeleton,
                            sequence_number)) {
    response_.set_sequence_number(sequence_number);
    convert::ToProto(positions_, response_.mutable_pose());
    ForwardKinematics(session_->skeleton(), positions_, world_from_skeleton,
                      frames_);
    convert::ToProto(frames_, response_.mutable_joint_frames());
    return Write();
  }
  if (now - last_write_ > state_->options.heartbeat) {
    response_.mutable_event()->set_kind(v1::StreamEvent::KIND_HEARTBEAT);
    return Write();
  }
  alarm_set_ = true;
  alarm_.Set(thread_->queue(), absl::ToChronoTime(now + interval_),
             alarmed_.tag());
}

void WatchSessionCall::Write() {
  last_write_ = absl::Now();
  writer_.Write(response_, written_.tag());
}

void WatchSessionCall::OnWritten(bool ok) {
  if (!ok) return Finish(absl::CancelledError("the viewer is gone"));
  if (said_ended_) return Finish(session_->ended());
  alarm_set_ = true;
  alarm_.Set(thread_->queue(), absl::ToChronoTime(last_write_ + interval_),
             alarmed_.tag());
}

void WatchSessionCall::OnAlarm(bool) {
  alarm_set_ = false;
  if (done_) return Finish(absl::CancelledError("the viewer is gone"));
  Look();
}

void WatchSessionCall::OnCancelled(bool) {
  done_ = true;
  if (alarm_set_) alarm_.Cancel();
  DeleteIfDone();
}

void WatchSessionCall::Finish(const absl::Status& status) {
  if (finishing_) return;
  finishing_ = true;
  writer_.Finish(ToGrpc(status), finished_.tag());
}

void WatchSessionCall::OnFinished(bool) {
  finished_call_ = true;
  DeleteIfDone();
}

void WatchSessionCall::DeleteIfDone() {
  if (finished_call_ && done_) delete this;
}

}  // namespace gelenk::server
