// The service that a command talks to: one that runs, or its own.
#ifndef CLIENT_CLI_SERVICE_H_
#define CLIENT_CLI_SERVICE_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "client/cli/local_server.h"
#include "gelenk/client/connection.h"

namespace gelenk::cli {

class Service {
 public:
  // `address` as gRPC takes it; empty hosts a server in this process.
  // UNAVAILABLE naming the address when nobody answers there.
  static absl::StatusOr<std::unique_ptr<Service>> Open(
      const std::string& address);

  const std::shared_ptr<client::Connection>& connection() const {
    return connection_;
  }

 private:
  Service(std::unique_ptr<LocalServer> local_server,
          std::shared_ptr<client::Connection> connection);

  // Outlives the connection.
  const std::unique_ptr<LocalServer> local_server_;
  const std::shared_ptr<client::Connection> connection_;
};

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SERVICE_H_
