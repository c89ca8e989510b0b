// A few threads for work that streams must not wait behind: unary calls, cold
// solves, imports.
#ifndef GELENK_SERVER_RPC_WORKER_POOL_H_
#define GELENK_SERVER_RPC_WORKER_POOL_H_

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/functional/function_ref.h"
#include "gelenk/ik/ik_solver.h"

namespace gelenk::server {

class WorkerPool {
 public:
  // Gets the solver of the thread that runs it.
  using Work = std::function<void(IkSolver&)>;

  WorkerPool(int threads, int max_waiting, InstructionSet instruction_set);
  // Runs what waits, then joins.
  ~WorkerPool();

  // False, and `work` is not run, when too much waits already.
  [[nodiscard]] bool Submit(Work work);

  // Runs part(0) .. part(count - 1) on the calling thread and on those of the
  // pool that have nothing else to do, and returns when all have run. One such
  // loop has the pool's threads at a time: a second one runs on its caller's
  // alone. Takes no memory. A ParallelFor.
  void RunParts(int count, absl::FunctionRef<void(int)> part);

 private:
  struct Parts {
    const int count;
    const absl::FunctionRef<void(int)> part;
    std::atomic<int> next{0};
    int helpers = 0;  // guarded by the pool's mutex

    void Run() {
      for (int i = next++; i < count; i = next++) part(i);
    }
  };

  void Loop(InstructionSet instruction_set);

  const size_t max_waiting_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Work> waiting_ ABSL_GUARDED_BY(mutex_);
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  Parts* parts_ ABSL_GUARDED_BY(mutex_) = nullptr;
  std::condition_variable helped_;
  std::vector<std::thread> threads_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_WORKER_POOL_H_
