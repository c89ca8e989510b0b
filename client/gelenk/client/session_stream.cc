#include "gelenk/client/session_stream.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/client/status.h"
#include "gelenk/client/steady_time.h"

namespace gelenk::client {
namespace {

SteadyTime Now() { return std::chrono::steady_clock::now(); }

uint64_t SeedFromSystem() {
  std::random_device device;
  return (uint64_t{device()} << 32) | device();
}

// Worth another attempt. A call that ran out of time is: its server hangs.
bool IsPassing(const absl::Status& status) {
  return IsTransportLoss(status) || absl::IsDeadlineExceeded(status);
}

}  // namespace

absl::StatusOr<std::unique_ptr<SessionStream>> SessionStream::Open(
    std::shared_ptr<Connection> connection, const SessionStreamOptions& options,
    std::vector<SessionSpec> specs) {
  std::mt19937_64 random(options.seed.has_value() ? *options.seed
                                                  : SeedFromSystem());
  const absl::Status status = Complete(&specs, random);
  if (!status.ok()) return status;
  std::unique_ptr<SessionStream> stream(new SessionStream(
      std::move(connection), options, std::move(specs), random()));
  const absl::Status attached = stream->WaitUntilAttached();
  if (!attached.ok()) return attached;
  return stream;
}

SessionStream::SessionStream(std::shared_ptr<Connection> connection,
                             const SessionStreamOptions& options,
                             std::vector<SessionSpec> specs, uint64_t seed)
    : connection_(std::move(connection)),
      options_(options),
      slots_(std::move(specs)),
      told_(slots_.slots().size(), false),
      backoff_(options.backoff, seed),
      thread_([this] { Run(); }) {}

SessionStream::~SessionStream() {
  {
    Lock lock(mutex_);
    closing_down_ = true;
    abandoned_ = true;
    if (call_ != nullptr) call_->Cancel();
    run_event_.notify_all();
  }
  cancellation_.Cancel();
  thread_.join();
}

absl::Status SessionStream::WaitUntilAttached() {
  Lock lock(mutex_);
  const auto is_decided = [this] {
    return final_status_.has_value() || !slots_.status().ok() ||
           slots_.AllAttached();
  };
  const SteadyTime deadline = After(Now(), options_.open_timeout);
  if (!state_event_.wait_until(lock, deadline, is_decided)) {
    return last_failure_.ok()
               ? absl::DeadlineExceededError("the server does not answer")
               : last_failure_;
  }
  if (final_status_.has_value()) return *final_status_;
  opened_ = slots_.status().ok();
  return slots_.status();
}

// --- The caller's side ---

absl::Status SessionStream::Send(v1::TargetFrame frame,
                                 absl::Duration timeout) {
  Lock lock(mutex_);
  return Push(lock, std::move(frame), /*number=*/false, timeout, nullptr);
}

absl::StatusOr<int64_t> SessionStream::SendNext(v1::TargetFrame frame,
                                                absl::Duration timeout) {
  Lock lock(mutex_);
  int64_t sequence_number = 0;
  const absl::Status status =
      Push(lock, std::move(frame), /*number=*/true, timeout, &sequence_number);
  if (!status.ok()) return status;
  return sequence_number;
}

absl::Status SessionStream::Push(Lock& lock, v1::TargetFrame frame, bool number,
                                 absl::Duration timeout,
                                 int64_t* sequence_number) {
  Slot* slot = slots_.Find(frame.slot());
  if (slot == nullptr) {
    return absl::InvalidArgumentError(
        absl::StrCat("slot: there is no ", frame.slot()));
  }
  const auto may_go_on = [&] {
    return closing_down_ || slot->phase() == Slot::Phase::kEnded ||
           slot->HasRoom(frame, options_.window);
  };
  if (!may_go_on()) {
    if (slot->spec().frame_policy != v1::FRAME_POLICY_EVERY_FRAME) {
      return absl::ResourceExhaustedError(
          "goal_patch: too many wait to be sent");
    }
    if (!send_event_.wait_until(lock, After(Now(), timeout), may_go_on)) {
      return absl::DeadlineExceededError(
          absl::StrCat(slot->unanswered_count(), " frames wait for an answer"));
    }
  }
  if (slot->phase() == Slot::Phase::kEnded) return slot->status();
  if (closing_down_) return absl::CancelledError("the stream is closed");
  if (number) {
    frame.set_sequence_number(slot->last_sequence_number() + 1);
    *sequence_number = frame.sequence_number();
  }
  absl::Status status = slot->CheckNumber(frame.sequence_number());
  if (!status.ok()) return status;
  slot->Push(std::move(frame), Now(), &slots_.statistics());
  Pump();
  return absl::OkStatus();
}

absl::StatusOr<std::optional<v1::PoseFrame>> SessionStream::Receive(
    absl::Duration timeout) {
  Lock lock(mutex_);
  const auto find_untold = [this] {
    size_t i = 0;
    while (i < told_.size() &&
           (told_[i] || slots_.slots()[i].phase() != Slot::Phase::kEnded)) {
      ++i;
    }
    return i;
  };
  receive_event_.wait_until(lock, After(Now(), timeout), [&] {
    return !answers_.empty() || final_status_.has_value() ||
           find_untold() < told_.size();
  });
  if (!answers_.empty()) {
    std::optional<v1::PoseFrame> answer(std::move(answers_.front()));
    answers_.pop_front();
    return answer;
  }
  const size_t ended = find_untold();
  if (ended < told_.size() && !closing_down_) {
    told_[ended] = true;
    return slots_.slots()[ended].status();
  }
  if (!final_status_.has_value()) return std::optional<v1::PoseFrame>();
  if (!final_status_->ok()) return *final_status_;
  return absl::OutOfRangeError("the end of the stream");
}

absl::Status SessionStream::Close(absl::Duration timeout) {
  Lock lock(mutex_);
  closing_down_ = true;
  send_event_.notify_all();
  run_event_.notify_all();
  Pump();
  const auto is_final = [this] { return final_status_.has_value(); };
  if (!state_event_.wait_until(lock, After(Now(), timeout), is_final)) {
    abandoned_ = true;
    if (call_ != nullptr) call_->Cancel();
    run_event_.notify_all();
    lock.unlock();
    cancellation_.Cancel();
    lock.lock();
    state_event_.wait(lock, is_final);
  }
  return *final_status_;
}

std::vector<SessionSpec> SessionStream::specs() const {
  Lock lock(mutex_);
  std::vector<SessionSpec> specs;
  for (const Slot& slot : slots_.slots()) specs.push_back(slot.spec());
  return specs;
}

int64_t SessionStream::LastSequenceNumber(int slot) const {
  Lock lock(mutex_);
  if (slot < 0 || slot >= static_cast<int>(slots_.slots().size())) return 0;
  return slots_.slots()[slot].last_sequence_number();
}

StreamStatistics SessionStream::statistics() const {
  Lock lock(mutex_);
  return slots_.statistics();
}

// --- Attempts ---

void SessionStream::Run() {
  Lock lock(mutex_);
  absl::Status status = RunAttempt(lock);
  while (IsPassing(status) && WaitToRetry(lock, status)) {
    ++slots_.statistics().reconnects;
    status = RunAttempt(lock);
  }
  Finish(status);
}

// OK when the stream has done what it was asked for.
absl::Status SessionStream::RunAttempt(Lock& lock) {
  if (IsComplete()) return absl::OkStatus();
  slots_.Rewind();
  absl::Status created = CreateAbsent(lock);
  if (!created.ok()) return created;
  return RunCall(lock);
}

absl::Status SessionStream::CreateAbsent(Lock& lock) {
  while (Slot* slot = slots_.FindAbsent()) {
    if (abandoned_) return absl::CancelledError("closed");
    absl::Status status;
    if (slot->NeedsAdoption()) {
      SessionSpec spec = slot->spec();
      lock.unlock();
      status = Adopt(&spec, *connection_, &cancellation_);
      lock.lock();
      if (status.ok()) slot->SetAdopted(std::move(spec));
    } else {
      const Creation creation = slot->NextCreation();
      lock.unlock();
      status = Create(creation, *connection_, &cancellation_);
      lock.lock();
      if (status.ok()) {
        slot->SetCreated();
        if (creation.again) ++slots_.statistics().recreated_sessions;
      }
    }
    if (IsPassing(status)) return status;
    if (!status.ok()) {
      slot->End(status);
      send_event_.notify_all();
      receive_event_.notify_all();
      state_event_.notify_all();
    }
  }
  return absl::OkStatus();
}

absl::Status SessionStream::RunCall(Lock& lock) {
  if (abandoned_) return absl::CancelledError("closed");
  if (slots_.AllEnded()) return slots_.status();
  call_status_.reset();
  closing_.reset();
  new_attempt_.reset();
  draining_ = false;
  silent_ = false;
  last_arrival_ = Now();
  call_ = std::make_unique<StreamCall>(&mutex_,
                                       static_cast<StreamCall::Owner*>(this));
  call_->Start(AffinityKey(slots_.slots().front().spec()), *connection_);
  Pump();
  while (!call_status_.has_value()) {
    if (slots_.FindAbsent() != nullptr && !new_attempt_.has_value()) {
      const absl::Status created = CreateAbsent(lock);
      if (!created.ok()) new_attempt_ = created;
      Pump();
      continue;
    }
    silent_ = Now() >= CallDeadline();
    if (new_attempt_.has_value() || abandoned_ || silent_) {
      call_->Cancel();
      run_event_.wait(lock, [this] { return call_status_.has_value(); });
      break;
    }
    run_event_.wait_until(lock, CallDeadline());
  }
  absl::Status status = StatusOfCall();
  call_.reset();
  return status;
}

absl::Status SessionStream::StatusOfCall() const {
  if (IsComplete()) return absl::OkStatus();
  if (abandoned_) return absl::CancelledError("closed");
  if (slots_.AllEnded()) return slots_.status();
  if (new_attempt_.has_value()) return *new_attempt_;
  if (silent_) {
    return absl::UnavailableError(absl::StrCat(
        "nothing heard for ", absl::FormatDuration(options_.silence_timeout)));
  }
  if (closing_.has_value() && !closing_->ok()) return *closing_;
  if (draining_) return absl::UnavailableError("the server is draining");
  if (call_status_->ok()) {
    return absl::UnavailableError("the server ended the stream");
  }
  return *call_status_;
}

bool SessionStream::WaitToRetry(Lock& lock, const absl::Status& failure) {
  if (abandoned_) return false;
  last_failure_ = failure;
  const SteadyTime now = Now();
  if (!failing_since_.has_value()) failing_since_ = now;
  const absl::Duration patience =
      opened_ ? options_.give_up_after : options_.open_timeout;
  if (now >= After(*failing_since_, patience)) return false;
  run_event_.wait_until(lock, After(now, backoff_.Next()),
                        [this] { return abandoned_ || IsComplete(); });
  return !abandoned_;
}

void SessionStream::Finish(absl::Status status) {
  const int64_t unanswered = slots_.unanswered_count();
  if (abandoned_) {
    status = unanswered == 0 ? absl::OkStatus()
                             : absl::DeadlineExceededError(absl::StrCat(
                                   unanswered, " frames without answer"));
  }
  if (status.ok()) status = slots_.status();
  slots_.End(status.ok() ? absl::CancelledError("the stream is closed")
                         : status);
  final_status_ = status;
  send_event_.notify_all();
  receive_event_.notify_all();
  state_event_.notify_all();
}

// --- The call in progress ---

bool SessionStream::IsComplete() const {
  return closing_down_ && slots_.unanswered_count() == 0;
}

bool SessionStream::ShouldHalfClose() const {
  return draining_ || closing_.has_value() || IsComplete() || slots_.AllEnded();
}

SteadyTime SessionStream::CallDeadline() const {
  const SteadyTime silence = After(last_arrival_, options_.silence_timeout);
  if (!call_->half_closed()) return silence;
  return std::min(silence,
                  After(half_close_time_, options_.half_close_timeout));
}

void SessionStream::Pump() {
  if (call_ == nullptr || !call_->CanWrite()) return;
  if (ShouldHalfClose()) {
    call_->HalfClose();
    half_close_time_ = Now();
    run_event_.notify_all();
    return;
  }
  if (slots_.Write(options_.max_frames_per_message, options_.window,
                   call_->request())) {
    call_->Write();
  }
}

void SessionStream::OnResponse(v1::StreamingSolveResponse* response) {
  last_arrival_ = Now();
  const SlotTable::News news = slots_.Read(response, last_arrival_, &answers_);
  draining_ |= news.draining;
  if (news.closing.has_value()) closing_ = news.closing;
  if (news.new_attempt.has_value()) new_attempt_ = news.new_attempt;
  if (news.has_answers) {
    receive_event_.notify_one();
    send_event_.notify_one();
  }
  const bool is_idle = slots_.AllAttached() && slots_.unanswered_count() == 0;
  if (news.has_answers || is_idle) {
    failing_since_.reset();
    backoff_.Reset();
  }
  if (response->events_size() > 0) {
    run_event_.notify_all();
    send_event_.notify_all();
    receive_event_.notify_all();
    state_event_.notify_all();
  }
  Pump();
}

void SessionStream::OnWritten() { Pump(); }

void SessionStream::OnEnd(absl::Status status) {
  call_status_ = std::move(status);
  run_event_.notify_all();
}

}  // namespace gelenk::client
