#include "client/cli/local_server.h"

#include <utility>

#include "server/server.h"

namespace gelenk::cli {
namespace {

// What a connection sends at most: a mesh of this machine's own user may be
// larger than what a server takes from anybody.
constexpr int kMaxMessageBytes = 64 << 20;

class HostedServer final : public LocalServer {
 public:
  explicit HostedServer(std::unique_ptr<server::Server> server)
      : server_(std::move(server)) {}

  const std::string& address() const override { return server_->address(); }

 private:
  const std::unique_ptr<server::Server> server_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<LocalServer>> LocalServer::Start() {
  server::ServerOptions options;
  options.listen = "127.0.0.1:0";
  options.limits.max_message_bytes = kMaxMessageBytes;
  absl::StatusOr<std::unique_ptr<server::Server>> server =
      server::Server::Start(std::move(options));
  if (!server.ok()) return server.status();
  return std::make_unique<HostedServer>(*std::move(server));
}

}  // namespace gelenk::cli
