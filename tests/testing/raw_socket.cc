#include "tests/testing/raw_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"

namespace gelenk::testing {

RawSocket::RawSocket(int port)
    : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  if (fd_ < 0 || connect(fd_, reinterpret_cast<const sockaddr*>(&address),
                         sizeof(address)) != 0) {
    std::abort();
  }
}

RawSocket::~RawSocket() {
  if (fd_ >= 0) close(fd_);
}

bool RawSocket::Send(absl::string_view bytes) {
  return send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT) ==
         static_cast<ssize_t>(bytes.size());
}

std::string RawSocket::Receive(absl::Duration patience) {
  pollfd polled = {fd_, POLLIN, 0};
  if (poll(&polled, 1, static_cast<int>(absl::ToInt64Milliseconds(patience))) <=
      0) {
    return "";
  }
  char buffer[1 << 14];
  const ssize_t size = recv(fd_, buffer, sizeof(buffer), 0);
  return size > 0 ? std::string(buffer, size) : "";
}

bool RawSocket::WaitForClose(absl::Duration patience) {
  const absl::Time deadline = absl::Now() + patience;
  while (absl::Now() < deadline) {
    if (Receive(deadline - absl::Now()).empty()) {
      return absl::Now() < deadline;
    }
  }
  return false;
}

void RawSocket::Reset() {
  const linger at_once = {1, 0};
  setsockopt(fd_, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
  close(fd_);
  fd_ = -1;
}

std::string Http2Frame(int type, int flags, int stream,
                       absl::string_view payload) {
  const auto size = static_cast<uint32_t>(payload.size());
  const uint8_t header[] = {
      static_cast<uint8_t>(size >> 16),   static_cast<uint8_t>(size >> 8),
      static_cast<uint8_t>(size),         static_cast<uint8_t>(type),
      static_cast<uint8_t>(flags),        static_cast<uint8_t>(stream >> 24),
      static_cast<uint8_t>(stream >> 16), static_cast<uint8_t>(stream >> 8),
      static_cast<uint8_t>(stream)};
  return absl::StrCat(
      absl::string_view(reinterpret_cast<const char*>(header), sizeof(header)),
      payload);
}

std::string Http2Preface() {
  constexpr int kSettings = 4;
  return absl::StrCat("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
                      Http2Frame(kSettings, 0, 0, ""));
}

}  // namespace gelenk::testing
