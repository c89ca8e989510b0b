// What the calls of all services work on.
#ifndef GELENK_SERVER_RPC_SERVICE_STATE_H_
#define GELENK_SERVER_RPC_SERVICE_STATE_H_

#include <atomic>
#include <functional>
#include <string>

#include "absl/functional/function_ref.h"
#include "gelenk/base/parallel_for.h"
#include "server/options.h"
#include "server/rpc/worker_pool.h"
#include "server/session/session_registry.h"
#include "server/store/clip_store.h"
#include "server/store/skeleton_store.h"
#include "server/store/skin_store.h"

namespace gelenk::server {

struct ServiceState {
  ServiceState(const ServerOptions& server_options,
               const std::function<uint64_t()>& random)
      : options(server_options),
        skeletons({server_options.limits.max_skeletons,
                   server_options.limits.max_skeleton_bytes},
                  random),
        sessions(server_options.limits.max_sessions, random),
        clips({server_options.limits.max_clips,
               server_options.limits.max_clip_bytes,
               server_options.limits.max_clip_revisions},
              skeletons, random),
        skins({server_options.limits.max_skins,
               server_options.limits.max_skin_bytes,
               server_options.limits.max_skin_revisions},
              random),
        workers(server_options.worker_threads,
                server_options.limits.max_waiting_calls,
                server_options.instruction_set) {}

  const ServerOptions options;
  // Bytes that recordings may take; before the sessions, which give them back.
  std::atomic<int64_t> recording_bytes{0};
  SkeletonStore skeletons;
  SessionRegistry sessions;
  ClipStore clips;
  SkinStore skins;

  // SIGTERM was seen: no new sessions, streams are asked to leave.
  std::atomic<bool> draining{false};
  // The drain time is over: streams are ended.
  std::atomic<bool> closing{false};
  // Streams that stand, and imports that are under way.
  std::atomic<int> streams{0};
  std::atomic<int> imports{0};
  // Makes DriverIds; 0 is the unary driver.
  std::atomic<uint64_t> next_driver{1};

  // Last: its threads end before what they work on.
  WorkerPool workers;

  // Lends idle workers to loops in parts, as long as this lives.
  ParallelFor PartRunner() {
    return [this](int count, absl::FunctionRef<void(int)> part) {
      workers.RunParts(count, part);
    };
  }
};

// A place under a limit, given back when it goes.
class LimitedPlace {
 public:
  LimitedPlace(std::atomic<int>& count, int limit) : count_(count) {
    granted_ = ++count_ <= limit;
  }
  ~LimitedPlace() { --count_; }
  LimitedPlace(const LimitedPlace&) = delete;
  LimitedPlace& operator=(const LimitedPlace&) = delete;

  bool granted() const { return granted_; }

 private:
  std::atomic<int>& count_;
  bool granted_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SERVICE_STATE_H_
