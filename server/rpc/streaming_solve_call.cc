#include "server/rpc/streaming_solve_call.h"

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "server/clock.h"
#include "server/rpc/status.h"

namespace gelenk::server {
namespace {

constexpr int kWholeStream = -1;
// How long a client has to half-close once it was told that the stream closes.
constexpr absl::Duration kClosingGrace = absl::Seconds(1);

absl::Status NoSuchSlot(int slot) {
  Violations violations;
  violations.Add("slot", absl::StrCat("no session is attached to slot ", slot));
  return violations.ToStatus();
}

}  // namespace

void StreamingSolveCall::Start(v1::SessionService::AsyncService* service,
                               ServiceState* state, IoThread* thread) {
  new StreamingSolveCall(service, state, thread);
}

StreamingSolveCall::StreamingSolveCall(
    v1::SessionService::AsyncService* service, ServiceState* state,
    IoThread* thread)
    : service_(service), state_(state), thread_(thread), count_(*thread) {
  grpc::ServerCompletionQueue* queue = thread_->queue();
  service_->RequestStreamingSolve(&context_, &stream_, queue, queue,
                                  started_.tag());
}

StreamingSolveCall::~StreamingSolveCall() {
  if (ticking_) thread_->RemoveTicking(this);
}

void StreamingSolveCall::OnStarted(bool ok) {
  if (!ok) {  // the server is shutting down
    delete this;
    return;
  }
  Start(service_, state_, thread_);
  place_ = std::make_unique<LimitedPlace>(state_->streams,
                                          state_->options.limits.max_streams);
  if (!place_->granted()) {
    close_status_ = absl::ResourceExhaustedError("too many streams are open");
    Finish();
    return;
  }
  last_write_ = CoarseNow();
  responses_[filling_].Renew();
  thread_->AddTicking(this);
  ticking_ = true;
  StartRead();
}

void StreamingSolveCall::OnRead(bool ok) {
  reading_ = false;
  if (!ok) {
    half_closed_ = true;
  } else if (working_) {
    message_waits_ = true;
  } else {
    TakeMessage();
  }
  if (finished_call_) {
    DeleteIfDone();
    return;
  }
  Advance();
}

void StreamingSolveCall::TakeMessage() {
  has_message_ = true;
  next_attach_ = 0;
  next_frame_ = 0;
  next_detach_ = 0;
  read_time_ = Now();
  burst_begin_ = read_time_;
}

void StreamingSolveCall::OnWritten(bool ok) {
  writing_ = false;
  last_write_ = CoarseNow();
  // What is left of a message goes on in a turn of its own.
  if (has_message_) burst_begin_ = Now();
  if (!ok) broken_ = true;
  Advance();
}

void StreamingSolveCall::OnWorked(bool) {
  working_ = false;
  if (message_waits_) {
    message_waits_ = false;
    TakeMessage();
  }
  Advance();
}

void StreamingSolveCall::OnFillTime(bool) {
  fill_alarm_.SetRung();
  if (finished_call_) {
    DeleteIfDone();
    return;
  }
  fills_are_due_ = true;
  Advance();
}

void StreamingSolveCall::OnFinished(bool) {
  finished_call_ = true;
  DeleteIfDone();
}

void StreamingSolveCall::DeleteIfDone() {
  // A read or an alarm that is still under way comes back first.
  if (!reading_ && !fill_alarm_.is_set()) delete this;
}

void StreamingSolveCall::Advance() {
  if (working_ || finishing_) return;
  if (broken_) has_message_ = false;
  if (has_message_ && !Consume(thread_->solver(), false)) {
    ConsumeOnWorker();
    return;
  }
  if (fills_are_due_ && IsListening() && !FillSlots(thread_->solver(), false)) {
    ConsumeOnWorker();
    return;
  }
  fills_are_due_ = false;
  if (!writing_ && !broken_) {
    if (!AnswerMerged(thread_->solver(), false)) {
      ConsumeOnWorker();
      return;
    }
    FlushFills();
    const v1::StreamingSolveResponse& response = *responses_[filling_].get();
    if (response.frames_size() > 0 || response.events_size() > 0) {
      StartWrite();
    }
  }
  if (!has_message_ && !reading_ && !half_closed_ && !IsFull()) StartRead();
  if (fills_) SetFillAlarm();
  if ((half_closed_ || broken_) && !has_message_ && !writing_ && !reading_) {
    Finish();
  }
}

void StreamingSolveCall::Finish() {
  finishing_ = true;
  fill_alarm_.Cancel();
  stream_.Finish(ToGrpc(close_status_), finished_.tag());
}

bool StreamingSolveCall::Consume(IkSolver& solver, bool heavy_allowed) {
  const v1::StreamingSolveRequest& request = *request_.get();
  for (; next_attach_ < request.attach_size(); ++next_attach_) {
    const v1::AttachSession& attach = request.attach(next_attach_);
    if (IsFull()) return true;
    if (!AnswerLast(attach.slot(), solver, heavy_allowed)) return false;
    Attach(attach);
  }
  bool time_is_up = false;
  while (next_frame_ < request.frames_size()) {
    if (IsFull() || time_is_up) return true;
    if (!ConsumeFrame(request.frames(next_frame_), solver, heavy_allowed)) {
      return false;
    }
    ++next_frame_;
    // Asked after a frame, so that each turn gets one further.
    time_is_up =
        next_frame_ < request.frames_size() && Now() - burst_begin_ > kBurst;
  }
  for (; next_detach_ < request.detach_size(); ++next_detach_) {
    const int slot = request.detach(next_detach_);
    if (IsFull()) return true;
    if (!AnswerLast(slot, solver, heavy_allowed)) return false;
    Detach(slot, absl::OkStatus());
  }
  has_message_ = false;
  return true;
}

bool StreamingSolveCall::ConsumeFrame(const v1::TargetFrame& frame,
                                      IkSolver& solver, bool heavy_allowed) {
  const auto found = slots_.find(frame.slot());
  if (found == slots_.end()) {
    v1::PoseFrame* answer = AddAnswer(0);
    answer->set_slot(frame.slot());
    answer->set_sequence_number(frame.sequence_number());
    ToProto(NoSuchSlot(frame.slot()), answer->mutable_status());
    return true;
  }
  StreamSlot& slot = *found->second;
  if (slot.every_frame() && !heavy_allowed && slot.IsHeavy()) return false;
  const absl::Status status = slot.Take(frame, read_time_);
  if (status.ok()) {
    if (slot.every_frame()) AnswerSlot(frame.slot(), slot, solver);
    return true;
  }
  // What came before it is answered before it.
  if (slot.has_unanswered()) AnswerSlot(frame.slot(), slot, solver);
  FlushFill(frame.slot());
  slot.Refuse(frame, status, AddAnswer(slot.answer_bytes()));
  return true;
}

bool StreamingSolveCall::AnswerMerged(IkSolver& solver, bool heavy_allowed) {
  // From where the last message was full, so that no slot is left out for
  // ever.
  auto slot = slots_.upper_bound(last_merged_);
  for (size_t i = 0; i < slots_.size(); ++i, ++slot) {
    if (slot == slots_.end()) slot = slots_.begin();
    if (!slot->second->has_unanswered()) continue;
    if (filled_bytes_ >= kMaxAnswerBytes) return true;
    if (!AnswerLast(slot->first, solver, heavy_allowed)) return false;
    last_merged_ = slot->first;
  }
  return true;
}

bool StreamingSolveCall::AnswerLast(int index, IkSolver& solver,
                                    bool heavy_allowed) {
  const auto found = slots_.find(index);
  if (found == slots_.end()) return true;
  StreamSlot& slot = *found->second;
  if (!slot.has_unanswered()) return true;
  if (!heavy_allowed && slot.IsHeavy()) return false;
  AnswerSlot(index, slot, solver);
  return true;
}

void StreamingSolveCall::ConsumeOnWorker() {
  working_ = true;
  // Asked now: the next message may come while the worker is at it.
  const auto work = [this, has_message = has_message_,
                     fills =
                         fills_are_due_ && IsListening()](IkSolver& solver) {
    burst_begin_ = Now();
    if (has_message) Consume(solver, true);
    if (fills) FillSlots(solver, true);
    AnswerMerged(solver, true);
    alarm_.Set(thread_->queue(), std::chrono::system_clock::now(),
               worked_.tag());
  };
  // With the pool overrun the stream's own thread has to do.
  if (!state_->workers.Submit(work)) work(thread_->solver());
}

void StreamingSolveCall::AnswerSlot(int index, StreamSlot& slot,
                                    IkSolver& solver) {
  FlushFill(index);
  v1::PoseFrame* answer = AddAnswer(slot.answer_bytes());
  const absl::Status status = slot.Answer(solver, read_time_, answer);
  if (status.ok()) {
    filled_bytes_ += answer->continuation().size();
    return;
  }
  // Lost between taking the frame and solving; the next tick says so.
  answer->set_slot(index);
  ToProto(status, answer->mutable_status());
}

void StreamingSolveCall::Attach(const v1::AttachSession& request) {
  FlushFill(request.slot());
  slots_.erase(request.slot());
  const int max_slots = state_->options.limits.max_slots;
  v1::StreamEvent attached;
  absl::StatusOr<std::unique_ptr<StreamSlot>> slot =
      absl::ResourceExhaustedError(
          absl::StrCat("attach: want at most ", max_slots, " slots"));
  if (slots_.size() < static_cast<size_t>(max_slots)) {
    slot = StreamSlot::Attach(
        *state_, request,
        slots_.empty() ? nullptr : &slots_.begin()->second->session(),
        read_time_, &attached);
  }
  if (!slot.ok()) {
    v1::StreamEvent* event =
        AddEvent(v1::StreamEvent::KIND_DETACHED, request.slot());
    ToProto(slot.status(), event->mutable_status());
    return;
  }
  fills_ |= (*slot)->fills();
  *responses_[filling_].get()->add_events() = attached;
  slots_[request.slot()] = *std::move(slot);
}

void StreamingSolveCall::Detach(int index, const absl::Status& why) {
  const auto found = slots_.find(index);
  const bool known = found != slots_.end();
  const int64_t newest = known ? found->second->session().sequence_number() : 0;
  FlushFill(index);
  if (known) slots_.erase(found);
  v1::StreamEvent* event = AddEvent(v1::StreamEvent::KIND_DETACHED, index);
  event->set_sequence_number(newest);
  ToProto(known ? why : NoSuchSlot(index), event->mutable_status());
}

v1::StreamEvent* StreamingSolveCall::AddEvent(v1::StreamEvent::Kind kind,
                                              int slot) {
  v1::StreamEvent* event = responses_[filling_].get()->add_events();
  event->set_kind(kind);
  event->set_slot(slot);
  return event;
}

v1::PoseFrame* StreamingSolveCall::AddAnswer(size_t bytes) {
  filled_bytes_ += bytes;
  return responses_[filling_].get()->add_frames();
}

bool StreamingSolveCall::IsFull() const {
  const v1::StreamingSolveResponse& response = *responses_[filling_].get();
  const int unsent = response.frames_size() + response.events_size();
  return unsent >= state_->options.limits.max_unsent_answers ||
         filled_bytes_ >= kMaxAnswerBytes;
}

void StreamingSolveCall::StartRead() {
  reading_ = true;
  stream_.Read(request_.Renew(), read_.tag());
}

void StreamingSolveCall::StartWrite() {
  writing_ = true;
  last_write_ = CoarseNow();
  const v1::StreamingSolveResponse& response = *responses_[filling_].get();
  filling_ = 1 - filling_;
  filled_bytes_ = 0;
  responses_[filling_].Renew();
  stream_.Write(response, written_.tag());
}

void StreamingSolveCall::Tick(absl::Time now) {
  if (working_ || finishing_) return;
  if (writing_ && now - last_write_ > state_->options.limits.write_stall) {
    // Nothing more can be said to a client that does not read.
    close_status_ =
        absl::ResourceExhaustedError("the client does not read its answers");
    context_.TryCancel();
    return;
  }
  CheckSlots();
  if (state_->draining && !said_draining_) {
    said_draining_ = true;
    ToProto(absl::UnavailableError("the server is going away"),
            AddEvent(v1::StreamEvent::KIND_DRAINING, kWholeStream)
                ->mutable_status());
  }
  if (state_->closing && !closing_) {
    Close(absl::UnavailableError("the server's drain time is over"));
  }
  if (closing_ && !writing_ && now - closing_since_ > kClosingGrace) {
    Finish();
    return;
  }
  if (!writing_ && now - last_write_ > state_->options.heartbeat) {
    AddEvent(v1::StreamEvent::KIND_HEARTBEAT, kWholeStream);
  }
  Advance();
}

void StreamingSolveCall::CheckSlots() {
  for (auto it = slots_.begin(); it != slots_.end();) {
    const auto [index, why] =
        std::make_pair(it->first, it->second->CheckDriver());
    ++it;
    if (!why.ok()) Detach(index, why);
  }
}

void StreamingSolveCall::Close(const absl::Status& why) {
  closing_ = true;
  closing_since_ = Now();
  close_status_ = why;
  ToProto(
      why,
      AddEvent(v1::StreamEvent::KIND_CLOSING, kWholeStream)->mutable_status());
}

}  // namespace gelenk::server
