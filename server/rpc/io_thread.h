// A thread that serves streams: one completion queue, the calls on it, one
// solver for their frames.
//
// A call is touched by its thread only, so calls need no locks. Several times a
// second each call gets a tick, for whatever is about time.
#ifndef GELENK_SERVER_RPC_IO_THREAD_H_
#define GELENK_SERVER_RPC_IO_THREAD_H_

#include <grpcpp/alarm.h>
#include <grpcpp/completion_queue.h>

#include <atomic>
#include <memory>
#include <thread>
#include <unordered_set>

#include "absl/time/time.h"
#include "gelenk/ik/ik_solver.h"
#include "server/rpc/completion.h"

namespace gelenk::server {

// A call that wants to know how time goes by. The tick may delete the call.
class Ticking {
 public:
  virtual ~Ticking() = default;
  virtual void Tick(absl::Time now) = 0;
};

class IoThread {
 public:
  static constexpr absl::Duration kTick = absl::Milliseconds(100);

  IoThread(std::unique_ptr<grpc::ServerCompletionQueue> queue,
           InstructionSet instruction_set);
  ~IoThread();

  void Start();
  // Waits until the last call has ended, then stops the thread: a queue that is
  // shut down while a call may still post to it aborts gRPC. The server must be
  // shutting down already.
  void Join();

  grpc::ServerCompletionQueue* queue() { return queue_.get(); }
  IkSolver& solver() { return solver_; }

  // From the thread itself.
  void AddTicking(Ticking* call) { ticking_.insert(call); }
  void RemoveTicking(Ticking* call) { ticking_.erase(call); }

  // Calls, accepted or waiting to be; counted by CallCount.
  std::atomic<int>& live_calls() { return live_calls_; }

 private:
  void Loop();
  void OnTick(bool ok);

  std::unique_ptr<grpc::ServerCompletionQueue> queue_;
  IkSolver solver_;
  std::unordered_set<Ticking*> ticking_;
  std::atomic<int> live_calls_{0};
  std::atomic<bool> stopping_{false};
  std::atomic<bool> tick_ended_{false};
  grpc::Alarm alarm_;
  Operation<IoThread> tick_{this, &IoThread::OnTick};
  std::thread thread_;
};

// Counts a call as live as long as it stands.
class CallCount {
 public:
  explicit CallCount(IoThread& thread) : count_(thread.live_calls()) {
    ++count_;
  }
  ~CallCount() { --count_; }
  CallCount(const CallCount&) = delete;
  CallCount& operator=(const CallCount&) = delete;

 private:
  std::atomic<int>& count_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_IO_THREAD_H_
