#include "server/rpc/worker_pool.h"

#include <utility>

#include "server/rpc/solver_clock.h"

namespace gelenk::server {

WorkerPool::WorkerPool(int threads, int max_waiting,
                       InstructionSet instruction_set)
    : max_waiting_(max_waiting) {
  for (int i = 0; i < threads; ++i) {
    threads_.emplace_back([this, instruction_set] { Loop(instruction_set); });
  }
}

WorkerPool::~WorkerPool() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  for (std::thread& thread : threads_) thread.join();
}

bool WorkerPool::Submit(Work work) {
  absl::MutexLock lock(&mutex_);
  if (waiting_.size() >= max_waiting_) return false;
  waiting_.push_back(std::move(work));
  return true;
}

void WorkerPool::Loop(InstructionSet instruction_set) {
  IkSolver solver(instruction_set, &SolverClock);
  for (;;) {
    Work work;
    {
      absl::MutexLock lock(&mutex_);
      mutex_.Await(absl::Condition(this, &WorkerPool::HasWork));
      if (waiting_.empty()) return;
      work = std::move(waiting_.front());
      waiting_.pop_front();
    }
    work(solver);
  }
}

}  // namespace gelenk::server
