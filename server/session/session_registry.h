// The sessions of all tenants, by name, with sliding idle expiry.
//
// Thread-safe. Time and randomness are passed in.
#ifndef GELENK_SERVER_SESSION_SESSION_REGISTRY_H_
#define GELENK_SERVER_SESSION_SESSION_REGISTRY_H_

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
#include "server/session/request_log.h"
#include "server/session/session.h"

namespace gelenk::server {

class SessionRegistry {
 public:
  SessionRegistry(int max_sessions, std::function<uint64_t()> random);

  // What Create needs besides the name that it settles.
  using Make =
      std::function<absl::StatusOr<std::shared_ptr<Session>>(std::string name)>;

  // Makes and keeps a session. `id` is empty or checked. A repeated
  // `request_id` answers the session that the first one made.
  // ALREADY_EXISTS, RESOURCE_EXHAUSTED, or what `make` says.
  absl::StatusOr<std::shared_ptr<Session>> Create(absl::string_view tenant,
                                                  absl::string_view id,
                                                  absl::string_view request_id,
                                                  absl::Time now,
                                                  const Make& make);

  // NOT_FOUND also when expired.
  absl::StatusOr<std::shared_ptr<Session>> Find(absl::string_view tenant,
                                                absl::string_view name,
                                                absl::Time now) const;

  absl::Status Delete(absl::string_view tenant, absl::string_view name);

  // In order of name, the first `limit` after `after`.
  std::vector<std::shared_ptr<Session>> List(absl::string_view tenant,
                                             absl::string_view after,
                                             size_t limit,
                                             absl::Time now) const;

  // Ends what has expired; returns how many.
  int Sweep(absl::Time now);

  // Runs `remove` while no living session is on that skeleton and none can be
  // made; FAILED_PRECONDITION when there is one.
  absl::Status RemoveUnused(absl::string_view tenant,
                            absl::string_view skeleton_name, absl::Time now,
                            const std::function<absl::Status()>& remove) const;

  int size() const;

 private:
  const int max_sessions_;
  const std::function<uint64_t()> random_;
  mutable std::shared_mutex mutex_;
  std::map<ResourceKey, std::shared_ptr<Session>> sessions_
      ABSL_GUARDED_BY(mutex_);
  RequestLog requests_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_SESSION_REGISTRY_H_
