#include "tests/testing/solve_stream.h"

#include <chrono>
#include <utility>

namespace gelenk::testing {
namespace {

std::chrono::system_clock::time_point After(absl::Duration duration) {
  return std::chrono::system_clock::now() +
         absl::ToChronoMicroseconds(duration);
}

// The front of `waiting`; none when it is empty.
template <class T>
std::optional<T> TakeFront(std::deque<T>& waiting) {
  if (waiting.empty()) return std::nullopt;
  std::optional<T> front(std::move(waiting.front()));
  waiting.pop_front();
  return front;
}

}  // namespace

SolveStream::SolveStream(v1::SessionService::Stub& stub) {
  Begin(kStart);
  stream_ = stub.AsyncStreamingSolve(&context_, &queue_, Pointer(kStart));
  Await(kStart, kPatience);
}

SolveStream::~SolveStream() {
  Cancel();
  static_cast<void>(Finish());
  queue_.Shutdown();
  void* tag;
  bool ok;
  while (queue_.Next(&tag, &ok)) {
  }
}

bool SolveStream::Await(Tag wanted, absl::Duration patience) {
  const auto deadline = After(patience);
  while (under_way_[wanted]) {
    void* pointer;
    bool ok;
    if (queue_.AsyncNext(&pointer, &ok, deadline) !=
        grpc::CompletionQueue::GOT_EVENT) {
      return false;
    }
    bool* const flag = static_cast<bool*>(pointer);
    const auto tag = static_cast<Tag>(flag - under_way_);
    *flag = false;
    ok_[tag] = ok;
    if (tag == kRead && ok) TakeMessage();
  }
  return true;
}

void SolveStream::TakeMessage() {
  ++message_count_;
  for (v1::PoseFrame& frame : *response_.mutable_frames()) {
    frames_.push_back(std::move(frame));
  }
  for (v1::StreamEvent& event : *response_.mutable_events()) {
    events_.push_back(std::move(event));
  }
}

bool SolveStream::Send(const v1::StreamingSolveRequest& request,
                       absl::Duration patience) {
  if (half_closed_ || !ok_[kStart] || !Await(kWrite, patience) ||
      !ok_[kWrite]) {
    return false;
  }
  Begin(kWrite);
  stream_->Write(request, Pointer(kWrite));
  return Await(kWrite, patience) && ok_[kWrite];
}

bool SolveStream::Attach(const v1::AttachSession& attach) {
  v1::StreamingSolveRequest request;
  *request.add_attach() = attach;
  return Send(request);
}

bool SolveStream::SendFrame(const v1::TargetFrame& frame) {
  v1::StreamingSolveRequest request;
  *request.add_frames() = frame;
  return Send(request);
}

bool SolveStream::Read(absl::Duration patience) {
  if (!ok_[kStart] || !ok_[kRead]) return false;
  if (!under_way_[kRead]) {
    Begin(kRead);
    stream_->Read(&response_, Pointer(kRead));
  }
  return Await(kRead, patience) && ok_[kRead];
}

std::optional<v1::PoseFrame> SolveStream::NextFrame(absl::Duration patience) {
  const absl::Time deadline = absl::Now() + patience;
  while (frames_.empty() && Read(deadline - absl::Now())) {
  }
  return TakeFront(frames_);
}

std::optional<v1::StreamEvent> SolveStream::NextEvent(absl::Duration patience) {
  const absl::Time deadline = absl::Now() + patience;
  while (events_.empty() && Read(deadline - absl::Now())) {
  }
  return TakeFront(events_);
}

std::optional<v1::StreamEvent> SolveStream::NextNews(absl::Duration patience) {
  const absl::Time deadline = absl::Now() + patience;
  for (;;) {
    std::optional<v1::StreamEvent> event = NextEvent(deadline - absl::Now());
    if (!event || event->kind() != v1::StreamEvent::KIND_HEARTBEAT) {
      return event;
    }
  }
}

std::vector<v1::PoseFrame> SolveStream::NextFrames(int count) {
  std::vector<v1::PoseFrame> frames;
  while (static_cast<int>(frames.size()) < count) {
    std::optional<v1::PoseFrame> frame = NextFrame();
    if (!frame) break;
    frames.push_back(*std::move(frame));
  }
  return frames;
}

void SolveStream::HalfClose() {
  if (half_closed_ || !ok_[kStart]) return;
  if (!Await(kWrite, kPatience)) Cancel();
  half_closed_ = true;
  Begin(kHalfClose);
  stream_->WritesDone(Pointer(kHalfClose));
  if (!Await(kHalfClose, kPatience)) Cancel();
}

absl::Status SolveStream::Finish() {
  if (!finished_) {
    while (Read(kPatience)) {
    }
    if (ok_[kRead]) Cancel();
    Begin(kFinish);
    stream_->Finish(&status_, Pointer(kFinish));
    if (!Await(kFinish, kPatience)) {
      Cancel();
      Await(kFinish, kPatience);
    }
    finished_ = true;
  }
  return absl::Status(static_cast<absl::StatusCode>(status_.error_code()),
                      status_.error_message());
}

}  // namespace gelenk::testing
