#include "server/session/session_registry.h"

#include <mutex>
#include <shared_mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace gelenk::server {
namespace {

absl::Status Expired(const Session& session) {
  return absl::NotFoundError(
      absl::StrCat("session: ", session.name(), " has expired"));
}

}  // namespace

SessionRegistry::SessionRegistry(int max_sessions,
                                 std::function<uint64_t()> random)
    : max_sessions_(max_sessions), random_(std::move(random)) {}

absl::StatusOr<std::shared_ptr<Session>> SessionRegistry::Create(
    absl::string_view tenant, absl::string_view id,
    absl::string_view request_id, absl::Time now, const Make& make) {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  const std::string earlier = requests_.Find(tenant, request_id);
  if (!earlier.empty()) {
    const auto found = sessions_.find({std::string(tenant), earlier});
    if (found != sessions_.end() && !found->second->IsExpired(now)) {
      return found->second;
    }
  }
  const std::string name = ResourceName(
      kSessions, id.empty() ? MakeResourceId("s", random_()) : std::string(id));
  const ResourceKey key(tenant, name);
  const auto found = sessions_.find(key);
  if (found != sessions_.end() && !found->second->IsExpired(now)) {
    return absl::AlreadyExistsError(
        absl::StrCat("session_id: ", name, " exists"));
  }
  if (found == sessions_.end() &&
      sessions_.size() >= static_cast<size_t>(max_sessions_)) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "session: %d sessions are open, no more are taken", max_sessions_));
  }
  absl::StatusOr<std::shared_ptr<Session>> session = make(name);
  if (!session.ok()) return session.status();
  if (found != sessions_.end()) found->second->End(Expired(*found->second));
  sessions_[key] = *session;
  requests_.Add(tenant, request_id, name);
  return session;
}

absl::StatusOr<std::shared_ptr<Session>> SessionRegistry::Find(
    absl::string_view tenant, absl::string_view name, absl::Time now) const {
  std::shared_lock<std::shared_mutex> lock(mutex_);
  const auto found = sessions_.find({std::string(tenant), std::string(name)});
  if (found == sessions_.end() || found->second->IsExpired(now)) {
    return NoSuchResource(name);
  }
  return found->second;
}

absl::Status SessionRegistry::Delete(absl::string_view tenant,
                                     absl::string_view name) {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  const auto found = sessions_.find({std::string(tenant), std::string(name)});
  if (found == sessions_.end()) return NoSuchResource(name);
  found->second->End(
      absl::NotFoundError(absl::StrCat("session: ", name, " was deleted")));
  sessions_.erase(found);
  return absl::OkStatus();
}

std::vector<std::shared_ptr<Session>> SessionRegistry::List(
    absl::string_view tenant, absl::string_view after, size_t limit,
    absl::Time now) const {
  std::shared_lock<std::shared_mutex> lock(mutex_);
  std::vector<std::shared_ptr<Session>> page;
  auto it = sessions_.upper_bound({std::string(tenant), std::string(after)});
  for (; it != sessions_.end() && it->first.first == tenant; ++it) {
    if (page.size() == limit) break;
    if (!it->second->IsExpired(now)) page.push_back(it->second);
  }
  return page;
}

int SessionRegistry::Sweep(absl::Time now) {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  int count = 0;
  for (auto it = sessions_.begin(); it != sessions_.end();) {
    if (!it->second->IsExpired(now)) {
      ++it;
      continue;
    }
    it->second->End(Expired(*it->second));
    it = sessions_.erase(it);
    ++count;
  }
  return count;
}

absl::Status SessionRegistry::RemoveUnused(
    absl::string_view tenant, absl::string_view skeleton_name, absl::Time now,
    const std::function<absl::Status()>& remove) const {
  std::lock_guard<std::shared_mutex> lock(mutex_);
  for (const auto& [key, session] : sessions_) {
    if (key.first == tenant && session->IsOn(skeleton_name) &&
        !session->IsExpired(now)) {
      return absl::FailedPreconditionError(
          absl::StrCat("name: ", session->name(), " is on ", skeleton_name));
    }
  }
  return remove();
}

int SessionRegistry::size() const {
  std::shared_lock<std::shared_mutex> lock(mutex_);
  return static_cast<int>(sessions_.size());
}

}  // namespace gelenk::server
