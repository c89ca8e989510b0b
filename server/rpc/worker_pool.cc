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

void WorkerPool::RunParts(int count, absl::FunctionRef<void(int)> part) {
  Parts parts = {count, part};
  bool have_help = false;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (parts_ == nullptr) {
      parts_ = &parts;
      have_help = true;
    }
  }
  if (have_help) changed_.notify_all();
  parts.Run();
  if (!have_help) return;
  std::unique_lock<std::mutex> lock(mutex_);
  parts_ = nullptr;  // nobody else comes
  helped_.wait(lock, [&parts] { return parts.helpers == 0; });
}

void WorkerPool::Loop(InstructionSet instruction_set) {
  IkSolver solver(instruction_set, &SolverClock);
  for (;;) {
    Work work;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      const auto has_parts = [this] {
        return parts_ != nullptr && parts_->next < parts_->count;
      };
      changed_.wait(
          lock, [&] { return stopping_ || !waiting_.empty() || has_parts(); });
      if (waiting_.empty()) {
        if (!has_parts()) return;
        Parts& parts = *parts_;
        ++parts.helpers;
        lock.unlock();
        parts.Run();
        lock.lock();
        if (--parts.helpers == 0) helped_.notify_all();
        continue;
      }
      work = std::move(waiting_.front());
      waiting_.pop_front();
    }
    work(solver);
  }
}

}  // namespace gelenk::server
