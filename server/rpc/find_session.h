// The session that a request names.
#ifndef GELENK_SERVER_RPC_FIND_SESSION_H_
#define GELENK_SERVER_RPC_FIND_SESSION_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/clock.h"
#include "server/rpc/service_state.h"
#include "server/session/resource_name.h"

namespace gelenk::server {

// INVALID_ARGUMENT naming `field` when `name` is malformed, NOT_FOUND when
// there is none of that name, or when it has expired.
inline absl::StatusOr<std::shared_ptr<Session>> FindSession(
    const ServiceState& state, absl::string_view field,
    const std::string& name) {
  absl::Status status = CheckResourceName(field, kSessions, name);
  if (!status.ok()) return status;
  return state.sessions.Find(kDefaultTenant, name, absl::Now());
}

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_FIND_SESSION_H_
