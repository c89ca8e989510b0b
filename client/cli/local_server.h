// The service in this process, for commands that are told no other.
#ifndef CLIENT_CLI_LOCAL_SERVER_H_
#define CLIENT_CLI_LOCAL_SERVER_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace gelenk::cli {

class LocalServer {
 public:
  // Listens on a free port that only this machine can reach.
  static absl::StatusOr<std::unique_ptr<LocalServer>> Start();

  // Ends what is still under way.
  virtual ~LocalServer() = default;

  // host:port
  virtual const std::string& address() const = 0;
};

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_LOCAL_SERVER_H_
