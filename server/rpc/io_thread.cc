#include "server/rpc/io_thread.h"

#include <chrono>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "server/rpc/solver_clock.h"

namespace gelenk::server {
namespace {

std::chrono::system_clock::time_point After(absl::Duration delay) {
  return absl::ToChronoTime(absl::Now() + delay);
}

}  // namespace

IoThread::IoThread(std::unique_ptr<grpc::ServerCompletionQueue> queue,
                   InstructionSet instruction_set)
    : queue_(std::move(queue)), solver_(instruction_set, &SolverClock) {}

IoThread::~IoThread() { Join(); }

void IoThread::Start() {
  alarm_.Set(queue_.get(), After(kTick), tick_.tag());
  thread_ = std::thread([this] { Loop(); });
}

void IoThread::Join() {
  if (!thread_.joinable()) return;
  while (live_calls_ > 0) absl::SleepFor(absl::Milliseconds(1));
  stopping_ = true;
  while (!tick_ended_) absl::SleepFor(absl::Milliseconds(1));
  queue_->Shutdown();
  thread_.join();
}

void IoThread::Loop() {
  void* tag;
  bool ok;
  while (queue_->Next(&tag, &ok)) Completion::Arrive(tag, ok);
}

void IoThread::OnTick(bool) {
  if (stopping_) {
    tick_ended_ = true;
    return;
  }
  // A tick may end calls, so walk over a copy.
  const std::vector<Ticking*> calls(ticking_.begin(), ticking_.end());
  const absl::Time now = absl::Now();
  for (Ticking* call : calls) {
    if (ticking_.contains(call)) call->Tick(now);
  }
  alarm_.Set(queue_.get(), After(kTick), tick_.tag());
}

}  // namespace gelenk::server
