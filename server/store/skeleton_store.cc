#include "server/store/skeleton_store.h"

#include <mutex>
#include <shared_mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/retarget/humanoid.h"
#include "server/session/resource_name.h"

namespace gelenk::server {
namespace {

std::map<std::string, StoredSkeleton, std::less<>> BundledSkeletons() {
  std::map<std::string, StoredSkeleton, std::less<>> bundled;
  for (absl::string_view id : BundledSkeletonNames()) {
    StoredSkeleton stored;
    stored.name = ResourceName(kSkeletons, id);
    stored.display_name = std::string(id);
    stored.create_time = absl::UnixEpoch();
    stored.skeleton = BundledSkeleton(id).value();
    stored.trees = std::make_shared<SharedTrees>(stored.skeleton);
    bundled.emplace(stored.name, std::move(stored));
  }
  return bundled;
}

}  // namespace

SkeletonStore::SkeletonStore(Bounds bounds, std::function<uint64_t()> random)
    : bounds_(bounds),
      random_(std::move(random)),
      bundled_(BundledSkeletons()) {}

absl::StatusOr<StoredSkeleton> SkeletonStore::Create(
    absl::string_view tenant, absl::string_view id,
    absl::string_view request_id, StoredSkeleton skeleton) {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  const std::string earlier = requests_.Find(tenant, request_id);
  if (!earlier.empty()) {
    const auto found = skeletons_.find({std::string(tenant), earlier});
    if (found != skeletons_.end()) return found->second;
  }
  skeleton.name =
      ResourceName(kSkeletons, id.empty() ? MakeResourceId("k", random_())
                                          : std::string(id));
  const ResourceKey key(tenant, skeleton.name);
  if (skeletons_.contains(key) || bundled_.contains(skeleton.name)) {
    return absl::AlreadyExistsError(
        absl::StrCat("skeleton_id: ", skeleton.name, " exists"));
  }
  const size_t bytes = skeleton.skeleton->ByteSize();
  if (skeletons_.size() >= static_cast<size_t>(bounds_.max_skeletons) ||
      bytes_ + bytes > bounds_.max_bytes) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "skeleton: %d skeletons of %d bytes are held, no more are taken",
        skeletons_.size(), bytes_));
  }
  bytes_ += bytes;
  skeleton.trees = std::make_shared<SharedTrees>(skeleton.skeleton);
  requests_.Add(tenant, request_id, skeleton.name);
  return skeletons_.emplace(key, std::move(skeleton)).first->second;
}

absl::StatusOr<StoredSkeleton> SkeletonStore::Find(
    absl::string_view tenant, absl::string_view name) const {
  if (const auto bundled = bundled_.find(name); bundled != bundled_.end()) {
    return bundled->second;
  }
  std::shared_lock<std::shared_mutex> lock(mutex_);
  const auto found = skeletons_.find({std::string(tenant), std::string(name)});
  if (found == skeletons_.end()) return NoSuchResource(name);
  return found->second;
}

absl::Status SkeletonStore::Delete(absl::string_view tenant,
                                   absl::string_view name) {
  if (bundled_.contains(name)) {
    return absl::FailedPreconditionError(
        absl::StrCat("name: ", name, " comes with the server and stays"));
  }
  std::lock_guard<std::shared_mutex> lock(mutex_);
  const auto found = skeletons_.find({std::string(tenant), std::string(name)});
  if (found == skeletons_.end()) return NoSuchResource(name);
  bytes_ -= found->second.skeleton->ByteSize();
  skeletons_.erase(found);
  return absl::OkStatus();
}

std::vector<StoredSkeleton> SkeletonStore::List(absl::string_view tenant,
                                                absl::string_view after,
                                                size_t limit) const {
  std::shared_lock<std::shared_mutex> lock(mutex_);
  std::vector<StoredSkeleton> page;
  auto it = skeletons_.upper_bound({std::string(tenant), std::string(after)});
  for (; it != skeletons_.end() && it->first.first == tenant; ++it) {
    if (page.size() == limit) break;
    page.push_back(it->second);
  }
  return page;
}

}  // namespace gelenk::server
