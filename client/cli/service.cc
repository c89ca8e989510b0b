#include "client/cli/service.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace gelenk::cli {
namespace {

constexpr absl::Duration kConnectTimeout = absl::Seconds(5);

}  // namespace

Service::Service(std::unique_ptr<LocalServer> local_server,
                 std::shared_ptr<client::Connection> connection)
    : local_server_(std::move(local_server)),
      connection_(std::move(connection)) {}

absl::StatusOr<std::unique_ptr<Service>> Service::Open(
    const std::string& address) {
  std::unique_ptr<LocalServer> local_server;
  std::string target = address;
  if (address.empty()) {
    absl::StatusOr<std::unique_ptr<LocalServer>> started = LocalServer::Start();
    if (!started.ok()) return started.status();
    local_server = *std::move(started);
    target = local_server->address();
  }
  auto connection = std::make_shared<client::Connection>(target);
  if (!connection->WaitForReady(kConnectTimeout).ok()) {
    return absl::UnavailableError(
        absl::StrCat("no server answers at ", target));
  }
  return std::unique_ptr<Service>(
      new Service(std::move(local_server), std::move(connection)));
}

}  // namespace gelenk::cli
