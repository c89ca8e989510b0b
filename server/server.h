// A gelenk server in this process: what `gelenkd` runs, and what the CLI hosts
// when it is given no other.
#ifndef GELENK_SERVER_SERVER_H_
#define GELENK_SERVER_SERVER_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/options.h"

namespace gelenk::server {

class Server {
 public:
  // Listens and serves on threads of its own. INVALID_ARGUMENT for bad options,
  // UNAVAILABLE when the address cannot be bound.
  static absl::StatusOr<std::unique_ptr<Server>> Start(ServerOptions options);

  // Ends everything at once unless Drain was called before.
  virtual ~Server() = default;

  // host:port, with the port that was picked.
  virtual const std::string& address() const = 0;

  // Streams that stand now.
  virtual int stream_count() const = 0;

  // Goes away gracefully: NOT_SERVING, no new sessions, streams are asked to
  // leave; after `grace` they are ended. Returns when nothing runs any more.
  virtual void Drain(absl::Duration grace) = 0;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SERVER_H_
