// Asks a server how it is: what the health check of a container runs.
#ifndef GELENK_SERVER_OPS_HEALTH_CHECK_H_
#define GELENK_SERVER_OPS_HEALTH_CHECK_H_

#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"

namespace gelenk::server {

// Where a program on the same machine reaches a server that was told to listen
// at `listen`: on loopback, if it listens on every address.
std::string LocalTarget(const std::string& listen);

// Calls grpc.health.v1.Health/Check for the whole server at `target`, without a
// proxy and without retries. OK when it says SERVING; UNAVAILABLE when it says
// anything else or nobody listens; DEADLINE_EXCEEDED after `patience`; else the
// error that it answered.
absl::Status CheckHealth(const std::string& target, absl::Duration patience);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_OPS_HEALTH_CHECK_H_
