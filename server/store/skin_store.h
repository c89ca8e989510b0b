// The skins of all tenants, with the revisions that edits made.
//
// In memory; a restart forgets them. A revision is immutable and shared with
// whoever deforms it. Of one skin the newest max_revisions are kept; where
// memory is short, older ones of the skin that is edited go first. Thread-safe.
#ifndef GELENK_SERVER_STORE_SKIN_STORE_H_
#define GELENK_SERVER_STORE_SKIN_STORE_H_

#include <array>
#include <cstdint>
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
#include "gelenk/skin/skin.h"
#include "gelenk/skin/skin_binding.h"
#include "server/session/request_log.h"

namespace gelenk::server {

struct SkinRevision {
  // From 1, rising, never used again.
  int64_t number = 1;
  // The revision that the edit started from; 0 for the first.
  int64_t base = 0;
  std::shared_ptr<const Skin> skin;
  // Of layered meshes, else zero.
  std::array<int, kBindingClassCount> class_counts = {};
  int stretched_edge_count = 0;
};

// A skin at one revision.
struct StoredSkin {
  std::string name;
  std::string display_name;
  std::string skeleton_name;
  absl::Time create_time;
  SkinRevision revision;
  // Of all revisions.
  size_t byte_size = 0;
};

class SkinStore {
 public:
  struct Bounds {
    int max_skins;
    size_t max_bytes;
    int max_revisions;
  };
  SkinStore(Bounds bounds, std::function<uint64_t()> random);

  // Keeps `skin` under `id` (checked), or one of its own when empty; fills its
  // name. `check` runs while no skeleton can be removed. A repeated
  // `request_id` answers what the first one made. ALREADY_EXISTS,
  // RESOURCE_EXHAUSTED, or what `check` says.
  absl::StatusOr<StoredSkin> Create(absl::string_view tenant,
                                    absl::string_view id,
                                    absl::string_view request_id,
                                    StoredSkin skin,
                                    const std::function<absl::Status()>& check);
  // What an earlier Create with that id made.
  std::optional<StoredSkin> FindCreated(absl::string_view tenant,
                                        absl::string_view request_id);

  // NOT_FOUND also for revisions that are no longer kept.
  absl::StatusOr<StoredSkin> Find(absl::string_view tenant,
                                  absl::string_view name,
                                  std::optional<int64_t> revision) const;

  // Adds `revision`, whose `base` is the one it was made from, and numbers it.
  // `expected` is the newest one there must still be: ABORTED when somebody
  // else was faster. RESOURCE_EXHAUSTED, NOT_FOUND.
  absl::StatusOr<StoredSkin> AddRevision(absl::string_view tenant,
                                         absl::string_view name,
                                         absl::string_view request_id,
                                         std::optional<int64_t> expected,
                                         SkinRevision revision);
  // What an earlier AddRevision to that skin with that id made.
  std::optional<StoredSkin> FindAdded(absl::string_view tenant,
                                      absl::string_view name,
                                      absl::string_view request_id);

  absl::Status Delete(absl::string_view tenant, absl::string_view name);

  // In order of name, the first `limit` after `after`.
  std::vector<StoredSkin> List(absl::string_view tenant,
                               absl::string_view after, size_t limit) const;

  // Runs `remove` while no skin is on that skeleton and none can be made;
  // FAILED_PRECONDITION when there is one.
  absl::Status RemoveUnused(absl::string_view tenant,
                            absl::string_view skeleton_name,
                            const std::function<absl::Status()>& remove) const;

 private:
  struct Entry {
    // Without a revision.
    StoredSkin about;
    std::deque<SkinRevision> revisions;  // never empty; the newest is last
  };
  // The newest revision, or that of `number`; nothing when there is none.
  static std::optional<StoredSkin> At(const Entry& entry,
                                      std::optional<int64_t> number);
  std::optional<StoredSkin> FindLocked(absl::string_view tenant,
                                       absl::string_view name,
                                       std::optional<int64_t> revision) const
      ABSL_SHARED_LOCKS_REQUIRED(mutex_);

  const Bounds bounds_;
  const std::function<uint64_t()> random_;
  mutable std::shared_mutex mutex_;
  std::map<ResourceKey, Entry> skins_ ABSL_GUARDED_BY(mutex_);
  size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  RequestLog creations_ ABSL_GUARDED_BY(mutex_);
  RequestLog edits_ ABSL_GUARDED_BY(mutex_);  // names with revisions
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_STORE_SKIN_STORE_H_
