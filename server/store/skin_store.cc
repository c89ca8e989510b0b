#include "server/store/skin_store.h"

#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "server/session/revision_name.h"

namespace gelenk::server {
namespace {

size_t BytesOf(const SkinRevision& revision) {
  return revision.skin->ByteSize();
}

}  // namespace

SkinStore::SkinStore(Bounds bounds, std::function<uint64_t()> random)
    : bounds_(bounds), random_(std::move(random)) {}

std::optional<StoredSkin> SkinStore::At(const Entry& entry,
                                        std::optional<int64_t> number) {
  for (auto it = entry.revisions.rbegin(); it != entry.revisions.rend(); ++it) {
    if (number && it->number != *number) continue;
    StoredSkin stored = entry.about;
    stored.revision = *it;
    return stored;
  }
  return std::nullopt;
}

std::optional<StoredSkin> SkinStore::FindLocked(
    absl::string_view tenant, absl::string_view name,
    std::optional<int64_t> revision) const {
  const auto found = skins_.find({std::string(tenant), std::string(name)});
  return found == skins_.end() ? std::nullopt : At(found->second, revision);
}

absl::StatusOr<StoredSkin> SkinStore::Create(
    absl::string_view tenant, absl::string_view id,
    absl::string_view request_id, StoredSkin skin,
    const std::function<absl::Status()>& check) {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  if (std::optional<StoredSkin> earlier = FindLocked(
          tenant, creations_.Find(tenant, request_id), std::nullopt)) {
    return *std::move(earlier);
  }
  skin.name = ResourceName(
      kSkins, id.empty() ? MakeResourceId("n", random_()) : std::string(id));
  const ResourceKey key(tenant, skin.name);
  if (skins_.contains(key)) {
    return absl::AlreadyExistsError(
        absl::StrCat("skin_id: ", skin.name, " exists"));
  }
  skin.byte_size = BytesOf(skin.revision);
  if (skins_.size() >= static_cast<size_t>(bounds_.max_skins) ||
      bytes_ + skin.byte_size > bounds_.max_bytes) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "skin: %d skins of %d bytes are held, no more are taken", skins_.size(),
        bytes_));
  }
  if (absl::Status status = check(); !status.ok()) return status;
  bytes_ += skin.byte_size;
  creations_.Add(tenant, request_id, skin.name);
  Entry& entry = skins_[key];
  entry.revisions.push_back(std::move(skin.revision));
  entry.about = std::move(skin);
  return *At(entry, std::nullopt);
}

std::optional<StoredSkin> SkinStore::FindCreated(absl::string_view tenant,
                                                 absl::string_view request_id) {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  return FindLocked(tenant, creations_.Find(tenant, request_id), std::nullopt);
}

absl::StatusOr<StoredSkin> SkinStore::Find(
    absl::string_view tenant, absl::string_view name,
    std::optional<int64_t> revision) const {
  std::shared_lock<std::shared_mutex> lock(mutex_);
  std::optional<StoredSkin> found = FindLocked(tenant, name, revision);
  if (found) return *std::move(found);
  return NoSuchResource(revision ? RevisionText(name, *revision)
                                 : std::string(name));
}

absl::StatusOr<StoredSkin> SkinStore::AddRevision(
    absl::string_view tenant, absl::string_view name,
    absl::string_view request_id, std::optional<int64_t> expected,
    SkinRevision revision) {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  const auto found = skins_.find({std::string(tenant), std::string(name)});
  if (found == skins_.end()) return NoSuchResource(name);
  Entry& entry = found->second;
  const int64_t newest = entry.revisions.back().number;
  if (expected && *expected != newest) {
    return absl::AbortedError(absl::StrFormat(
        "name: %s was changed meanwhile, it is at revision %d", name, newest));
  }
  // How many of the oldest have to go; the newest stays.
  const size_t bytes = BytesOf(revision);
  size_t dropped = 0;
  size_t freed = 0;
  const auto fits = [&] {
    return entry.revisions.size() - dropped <
               static_cast<size_t>(bounds_.max_revisions) &&
           bytes_ - freed + bytes <= bounds_.max_bytes;
  };
  while (!fits() && dropped + 1 < entry.revisions.size()) {
    freed += BytesOf(entry.revisions[dropped++]);
  }
  if (!fits()) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "skin: %d skins of %d bytes are held, there is no room for a revision",
        skins_.size(), bytes_));
  }
  entry.revisions.erase(entry.revisions.begin(),
                        entry.revisions.begin() + dropped);
  bytes_ = bytes_ - freed + bytes;
  entry.about.byte_size = entry.about.byte_size - freed + bytes;
  revision.number = newest + 1;
  edits_.Add(tenant, request_id, RevisionText(name, revision.number));
  entry.revisions.push_back(std::move(revision));
  return *At(entry, std::nullopt);
}

std::optional<StoredSkin> SkinStore::FindAdded(absl::string_view tenant,
                                               absl::string_view name,
                                               absl::string_view request_id) {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  const auto earlier =
      ParseRevisionName("request_id", kSkins, edits_.Find(tenant, request_id));
  if (!earlier.ok() || earlier->name != name) return std::nullopt;
  return FindLocked(tenant, name, earlier->revision);
}

absl::Status SkinStore::Delete(absl::string_view tenant,
                               absl::string_view name) {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  const auto found = skins_.find({std::string(tenant), std::string(name)});
  if (found == skins_.end()) return NoSuchResource(name);
  bytes_ -= found->second.about.byte_size;
  skins_.erase(found);
  return absl::OkStatus();
}

std::vector<StoredSkin> SkinStore::List(absl::string_view tenant,
                                        absl::string_view after,
                                        size_t limit) const {
  std::shared_lock<std::shared_mutex> lock(mutex_);
  std::vector<StoredSkin> page;
  auto it = skins_.upper_bound({std::string(tenant), std::string(after)});
  for (; it != skins_.end() && it->first.first == tenant; ++it) {
    if (page.size() == limit) break;
    page.push_back(*At(it->second, std::nullopt));
  }
  return page;
}

absl::Status SkinStore::RemoveUnused(
    absl::string_view tenant, absl::string_view skeleton_name,
    const std::function<absl::Status()>& remove) const {
  std::shared_lock<std::shared_mutex> lock(mutex_);
  for (const auto& [key, entry] : skins_) {
    if (key.first == tenant && entry.about.skeleton_name == skeleton_name) {
      return absl::FailedPreconditionError(
          absl::StrCat("name: ", key.second, " is on ", skeleton_name));
    }
  }
  return remove();
}

}  // namespace gelenk::server
