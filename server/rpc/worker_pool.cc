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
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool WorkerPool::Submit(Work work) {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (waiting_.size() >= max_waiting_) return false;
    waiting_.push_back(std::move(work));
  }
  changed_.notify_one();
  return true;
}

void WorkerPool::Loop(InstructionSet instruction_set) {
  IkSolver solver(instruction_set, &SolverClock);
  for (;;) {
    Work work;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      work = std::move(waiting_.front());
      waiting_.pop_front();
    }
    work(solver);
  }
}

}  // namespace gelenk::server
