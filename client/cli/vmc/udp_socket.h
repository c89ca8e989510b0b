// A UDP socket that waits no longer than it is told.
#ifndef CLIENT_CLI_VMC_UDP_SOCKET_H_
#define CLIENT_CLI_VMC_UDP_SOCKET_H_

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace gelenk::cli {

class UdpSocket {
 public:
  // Takes what comes to "port" or "host:port"; without a host from this machine
  // only. Port 0 picks a free one. INVALID_ARGUMENT for an address that is
  // none, UNAVAILABLE where it is taken.
  static absl::StatusOr<std::unique_ptr<UdpSocket>> Listen(
      const std::string& address);
  // Sends to "host:port".
  static absl::StatusOr<std::unique_ptr<UdpSocket>> Connect(
      const std::string& address);

  ~UdpSocket();
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  int port() const;

  // The next packet into `packet`; false when none came in time.
  bool Receive(absl::Duration timeout, std::string& packet);
  // Lost packets are no error: nobody may listen.
  void Send(absl::string_view packet);

 private:
  explicit UdpSocket(int file) : file_(file) {}

  const int file_;
};

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_VMC_UDP_SOCKET_H_
