// A few threads for work that streams must not wait behind: unary calls, cold
// solves, imports.
#ifndef GELENK_SERVER_RPC_WORKER_POOL_H_
#define GELENK_SERVER_RPC_WORKER_POOL_H_

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
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

 private:
  void Loop(InstructionSet instruction_set);

  const size_t max_waiting_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Work> waiting_ ABSL_GUARDED_BY(mutex_);
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::vector<std::thread> threads_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_WORKER_POOL_H_
