#include "server/store/clip_store.h"

#include <mutex>
#include <shared_mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "server/session/resource_name.h"

namespace gelenk::server {

size_t StoredClip::ByteSize() const {
  return sizeof(*this) - sizeof(MotionClip) + clip.ByteSize();
}

ClipStore::ClipStore(Bounds bounds, const SkeletonStore& skeletons,
                     std::function<uint64_t()> random)
    : bounds_(bounds), skeletons_(skeletons), random_(std::move(random)) {}

StoredClip ClipStore::WithRange(const Revisions& revisions, size_t index) {
  StoredClip clip = revisions[index];
  clip.oldest_revision = revisions.front().revision;
  clip.newest_revision = revisions.back().revision;
  return clip;
}

absl::StatusOr<StoredClip> ClipStore::At(const Revisions& revisions,
                                         const RevisionedName& name) {
  const int oldest = revisions.front().revision;
  const int newest = revisions.back().revision;
  const int64_t revision = name.revision.value_or(newest);
  if (revision < oldest || revision > newest) {
    return absl::NotFoundError(
        absl::StrFormat("name: no %s, revisions %d to %d are kept",
                        RevisionText(name.name, revision), oldest, newest));
  }
  return WithRange(revisions, revision - oldest);
}

std::optional<StoredClip> ClipStore::FindRequestLocked(
    absl::string_view tenant, absl::string_view request_id) const {
  const std::string earlier = requests_.Find(tenant, request_id);
  if (earlier.empty()) return std::nullopt;
  const RevisionedName name =
      ParseRevisionName("name", kClips, earlier).value();
  const auto found = clips_.find({std::string(tenant), name.name});
  if (found == clips_.end()) return std::nullopt;
  absl::StatusOr<StoredClip> clip = At(found->second, name);
  if (!clip.ok()) return std::nullopt;
  return *std::move(clip);
}

std::optional<StoredClip> ClipStore::FindRequest(
    absl::string_view tenant, absl::string_view request_id) const {
  std::shared_lock<std::shared_mutex> lock(mutex_);
  return FindRequestLocked(tenant, request_id);
}

absl::Status ClipStore::CheckRoomLocked(size_t bytes) const {
  if (bytes_ + bytes <= bounds_.max_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrFormat("clip: takes %d bytes, %d of %d are left", bytes,
                      bounds_.max_bytes - bytes_, bounds_.max_bytes));
}

absl::StatusOr<StoredClip> ClipStore::Create(absl::string_view tenant,
                                             absl::string_view id,
                                             absl::string_view request_id,
                                             StoredClip clip) {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  if (std::optional<StoredClip> earlier =
          FindRequestLocked(tenant, request_id)) {
    return *std::move(earlier);
  }
  // It may have been deleted since the clip was made.
  const absl::StatusOr<StoredSkeleton> skeleton =
      skeletons_.Find(tenant, clip.skeleton_name);
  if (!skeleton.ok()) return skeleton.status();
  if (skeleton->skeleton != clip.clip.skeleton()) {
    return absl::AbortedError(absl::StrCat("skeleton: ", clip.skeleton_name,
                                           " was replaced meanwhile"));
  }
  clip.name = ResourceName(
      kClips, id.empty() ? MakeResourceId("c", random_()) : std::string(id));
  const ResourceKey key(tenant, clip.name);
  if (clips_.contains(key)) {
    return absl::AlreadyExistsError(
        absl::StrCat("clip_id: ", clip.name, " exists"));
  }
  if (clips_.size() >= static_cast<size_t>(bounds_.max_clips)) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "clip: %d clips are held, no more are taken", clips_.size()));
  }
  const size_t bytes = clip.ByteSize();
  if (absl::Status status = CheckRoomLocked(bytes); !status.ok()) return status;
  bytes_ += bytes;
  clip.revision = 1;
  requests_.Add(tenant, request_id, RevisionText(clip.name, 1));
  Revisions& revisions = clips_[key];
  revisions.push_back(std::move(clip));
  return WithRange(revisions, 0);
}

absl::StatusOr<StoredClip> ClipStore::AddRevision(absl::string_view tenant,
                                                  absl::string_view request_id,
                                                  int newest, StoredClip clip) {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  if (std::optional<StoredClip> earlier =
          FindRequestLocked(tenant, request_id)) {
    return *std::move(earlier);
  }
  const auto found = clips_.find({std::string(tenant), clip.name});
  if (found == clips_.end()) return NoSuchResource(clip.name);
  Revisions& revisions = found->second;
  if (revisions.back().revision != newest) {
    return absl::AbortedError(
        absl::StrFormat("name: the newest revision of %s is %d by now, not %d",
                        clip.name, revisions.back().revision, newest));
  }
  const bool full =
      revisions.size() >= static_cast<size_t>(bounds_.max_revisions);
  const size_t bytes = clip.ByteSize();
  const size_t freed = full ? revisions.front().ByteSize() : 0;
  if (bytes > freed) {
    if (absl::Status status = CheckRoomLocked(bytes - freed); !status.ok()) {
      return status;
    }
  }
  bytes_ = bytes_ + bytes - freed;
  if (full) revisions.pop_front();
  clip.revision = newest + 1;
  requests_.Add(tenant, request_id, RevisionText(clip.name, clip.revision));
  revisions.push_back(std::move(clip));
  return WithRange(revisions, revisions.size() - 1);
}

absl::StatusOr<StoredClip> ClipStore::Find(absl::string_view tenant,
                                           const RevisionedName& name) const {
  std::shared_lock<std::shared_mutex> lock(mutex_);
  const auto found = clips_.find({std::string(tenant), name.name});
  if (found == clips_.end()) return NoSuchResource(name.name);
  return At(found->second, name);
}

absl::Status ClipStore::Delete(absl::string_view tenant,
                               absl::string_view name) {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  const auto found = clips_.find({std::string(tenant), std::string(name)});
  if (found == clips_.end()) return NoSuchResource(name);
  for (const StoredClip& clip : found->second) bytes_ -= clip.ByteSize();
  clips_.erase(found);
  return absl::OkStatus();
}

std::vector<StoredClip> ClipStore::List(absl::string_view tenant,
                                        absl::string_view after,
                                        size_t limit) const {
  std::shared_lock<std::shared_mutex> lock(mutex_);
  std::vector<StoredClip> page;
  auto it = clips_.upper_bound({std::string(tenant), std::string(after)});
  for (; it != clips_.end() && it->first.first == tenant; ++it) {
    if (page.size() == limit) break;
    page.push_back(WithRange(it->second, it->second.size() - 1));
  }
  return page;
}

absl::Status ClipStore::RemoveUnused(
    absl::string_view tenant, absl::string_view skeleton_name,
    const std::function<absl::Status()>& remove) const {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  for (const auto& [key, revisions] : clips_) {
    if (key.first == tenant &&
        revisions.front().skeleton_name == skeleton_name) {
      return absl::FailedPreconditionError(
          absl::StrCat("name: ", key.second, " is of ", skeleton_name));
    }
  }
  return remove();
}

}  // namespace gelenk::server
