// The skeletons of all tenants: immutable, shared by the sessions on them.
//
// In memory; a restart forgets them. Those that come with the library, as
// "skeletons/humanoid", are there for every tenant, count against no bound, are
// not listed, and stay. Thread-safe.
#ifndef GELENK_SERVER_STORE_SKELETON_STORE_H_
#define GELENK_SERVER_STORE_SKELETON_STORE_H_

#include <functional>
#include <map>
#include <memory>
#include <shared_mutex>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "gelenk/skeleton/skeleton.h"
#include "server/session/request_log.h"
#include "server/session/shared_trees.h"

namespace gelenk::server {

// A skeleton and what people say about it.
struct StoredSkeleton {
  std::string name;
  std::string display_name;
  std::vector<std::string> warnings;
  bool planar = false;
  absl::Time create_time;
  std::shared_ptr<const Skeleton> skeleton;
  // What its sessions are solved on; made by the store.
  std::shared_ptr<SharedTrees> trees;
};

class SkeletonStore {
 public:
  struct Bounds {
    int max_skeletons;
    size_t max_bytes;
  };
  SkeletonStore(Bounds bounds, std::function<uint64_t()> random);

  // Keeps `skeleton` under `id` (checked), or one of its own when empty; fills
  // its name. A repeated `request_id` answers what the first one made.
  // ALREADY_EXISTS (bundled ones, too), RESOURCE_EXHAUSTED.
  absl::StatusOr<StoredSkeleton> Create(absl::string_view tenant,
                                        absl::string_view id,
                                        absl::string_view request_id,
                                        StoredSkeleton skeleton);

  absl::StatusOr<StoredSkeleton> Find(absl::string_view tenant,
                                      absl::string_view name) const;
  // FAILED_PRECONDITION for a bundled one.
  absl::Status Delete(absl::string_view tenant, absl::string_view name);

  // In order of name, the first `limit` after `after`.
  std::vector<StoredSkeleton> List(absl::string_view tenant,
                                   absl::string_view after, size_t limit) const;

 private:
  const Bounds bounds_;
  const std::function<uint64_t()> random_;
  // By name.
  const std::map<std::string, StoredSkeleton, std::less<>> bundled_;
  mutable std::shared_mutex mutex_;
  std::map<ResourceKey, StoredSkeleton> skeletons_ ABSL_GUARDED_BY(mutex_);
  size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  RequestLog requests_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_STORE_SKELETON_STORE_H_
