#include "client/cli/vmc/udp_socket.h"

#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "absl/memory/memory.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "client/cli/vmc/osc_packet.h"

namespace gelenk::cli {
namespace {

constexpr int kMaxPort = 65535;

// "host:port", or "port" alone on this machine.
absl::StatusOr<addrinfo*> Resolve(const std::string& address) {
  const size_t colon = address.rfind(':');
  const std::string host =
      colon == std::string::npos ? "127.0.0.1" : address.substr(0, colon);
  const std::string port =
      colon == std::string::npos ? address : address.substr(colon + 1);
  // getaddrinfo takes larger ones modulo 65536.
  int number = 0;
  if (!absl::SimpleAtoi(port, &number) || number < 0 || number > kMaxPort) {
    return absl::InvalidArgumentError(absl::StrCat(
        "want HOST:PORT, a port up to ", kMaxPort, ", got \"", address, "\""));
  }
  addrinfo hints = {};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(host.c_str(), port.c_str(), &hints, &found);
  if (error == 0) return found;
  return absl::InvalidArgumentError(absl::StrCat(
      "want HOST:PORT, got \"", address, "\" (", gai_strerror(error), ")"));
}

using Attach = int (*)(int, const sockaddr*, socklen_t);

absl::StatusOr<int> Open(const std::string& address, Attach attach) {
  absl::StatusOr<addrinfo*> resolved = Resolve(address);
  if (!resolved.ok()) return resolved.status();
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> info(*resolved,
                                                            freeaddrinfo);
  const int file = socket(info->ai_family, info->ai_socktype | SOCK_CLOEXEC, 0);
  if (file >= 0 && attach(file, info->ai_addr, info->ai_addrlen) == 0) {
    return file;
  }
  const std::string why = std::strerror(errno);
  if (file >= 0) close(file);
  return absl::UnavailableError(absl::StrCat(address, ": ", why));
}

}  // namespace

absl::StatusOr<std::unique_ptr<UdpSocket>> UdpSocket::Listen(
    const std::string& address) {
  const absl::StatusOr<int> file = Open(address, bind);
  if (!file.ok()) return file.status();
  return absl::WrapUnique(new UdpSocket(*file));
}

absl::StatusOr<std::unique_ptr<UdpSocket>> UdpSocket::Connect(
    const std::string& address) {
  const absl::StatusOr<int> file = Open(address, connect);
  if (!file.ok()) return file.status();
  return absl::WrapUnique(new UdpSocket(*file));
}

UdpSocket::~UdpSocket() { close(file_); }

int UdpSocket::port() const {
  sockaddr_in address = {};
  socklen_t size = sizeof(address);
  getsockname(file_, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

bool UdpSocket::Receive(absl::Duration timeout, std::string& packet) {
  pollfd ready = {file_, POLLIN, 0};
  const auto wait_ms = static_cast<int>(absl::ToInt64Milliseconds(timeout));
  if (poll(&ready, 1, std::max(0, wait_ms)) != 1) return false;
  packet.resize(kMaxOscPacketBytes);
  const ssize_t size = recv(file_, packet.data(), packet.size(), 0);
  packet.resize(std::max<ssize_t>(size, 0));
  return size >= 0;
}

void UdpSocket::Send(absl::string_view packet) {
  // Nobody may listen; then the next one fails, too.
  [[maybe_unused]] const ssize_t sent =
      send(file_, packet.data(), packet.size(), MSG_NOSIGNAL);
}

}  // namespace gelenk::cli
