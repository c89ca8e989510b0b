// The clips of all tenants and their revisions: immutable, shared by those who
// play them.
//
// In memory; a restart forgets them. Thread-safe. Its lock is taken before that
// of the skeletons, which it keeps from being deleted below clips.
#ifndef GELENK_SERVER_STORE_CLIP_STORE_H_
#define GELENK_SERVER_STORE_CLIP_STORE_H_

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <shared_mutex>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "gelenk/formats/bvh_document.h"
#include "gelenk/formats/bvh_import.h"
#include "gelenk/motion/motion_clip.h"
#include "server/session/request_log.h"
#include "server/session/revision_name.h"
#include "server/store/skeleton_store.h"

namespace gelenk::server {

// How the BVH file looked that a clip came from.
struct BvhForm {
  // With its first frame at most.
  BvhDocument document;
  BvhImport import;
};

// One revision of a clip, and what people say about it.
struct StoredClip {
  // "clips/{id}", without the revision.
  std::string name = {};
  int revision = 1;
  std::string display_name = {};
  std::string skeleton_name = {};
  MotionClip clip;
  // Null for what came from no BVH file.
  std::shared_ptr<const BvhForm> form = nullptr;
  // Of the file, 0 without one.
  double unit_m = 0;
  std::vector<std::string> warnings = {};
  absl::Time create_time = {};
  // Those that are kept; filled by the store.
  int oldest_revision = 1;
  int newest_revision = 1;

  size_t ByteSize() const;
};

class ClipStore {
 public:
  struct Bounds {
    int max_clips;
    // All revisions of all clips together.
    size_t max_bytes;
    // Of one clip; the oldest go.
    int max_revisions;
  };
  ClipStore(Bounds bounds, const SkeletonStore& skeletons,
            std::function<uint64_t()> random);

  // What `request_id` made earlier, if that is still there.
  std::optional<StoredClip> FindRequest(absl::string_view tenant,
                                        absl::string_view request_id) const;

  // Keeps `clip` under `id` (checked), or one of its own when empty, as
  // revision 1; fills its name. A repeated `request_id` answers what the first
  // one made. ALREADY_EXISTS, RESOURCE_EXHAUSTED; NOT_FOUND when its skeleton
  // is gone.
  absl::StatusOr<StoredClip> Create(absl::string_view tenant,
                                    absl::string_view id,
                                    absl::string_view request_id,
                                    StoredClip clip);

  // Keeps `clip`, which has its name, as the next revision. ABORTED when the
  // newest one is not `newest`; NOT_FOUND, RESOURCE_EXHAUSTED.
  absl::StatusOr<StoredClip> AddRevision(absl::string_view tenant,
                                         absl::string_view request_id,
                                         int newest, StoredClip clip);

  // NOT_FOUND naming the clip, or the revisions that are kept.
  absl::StatusOr<StoredClip> Find(absl::string_view tenant,
                                  const RevisionedName& name) const;
  // With all revisions.
  absl::Status Delete(absl::string_view tenant, absl::string_view name);

  // The newest revisions in order of name, the first `limit` after `after`.
  std::vector<StoredClip> List(absl::string_view tenant,
                               absl::string_view after, size_t limit) const;

  // Runs `remove` while no clip is of that skeleton and none can be made;
  // FAILED_PRECONDITION when there is one.
  absl::Status RemoveUnused(absl::string_view tenant,
                            absl::string_view skeleton_name,
                            const std::function<absl::Status()>& remove) const;

 private:
  // Never empty; numbers grow by one.
  using Revisions = std::deque<StoredClip>;

  static StoredClip WithRange(const Revisions& revisions, size_t index);
  static absl::StatusOr<StoredClip> At(const Revisions& revisions,
                                       const RevisionedName& name);
  std::optional<StoredClip> FindRequestLocked(
      absl::string_view tenant, absl::string_view request_id) const
      ABSL_SHARED_LOCKS_REQUIRED(mutex_);
  absl::Status CheckRoomLocked(size_t bytes) const
      ABSL_SHARED_LOCKS_REQUIRED(mutex_);

  const Bounds bounds_;
  const SkeletonStore& skeletons_;
  const std::function<uint64_t()> random_;
  mutable std::shared_mutex mutex_;
  std::map<ResourceKey, Revisions> clips_ ABSL_GUARDED_BY(mutex_);
  size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  // Names with revisions.
  RequestLog requests_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_STORE_CLIP_STORE_H_
