#include "tests/testing/tcp_relay.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>

#include "absl/strings/str_cat.h"

namespace gelenk::testing {
namespace {

sockaddr_in Loopback(int port) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  return address;
}

int MakeSocket() {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) std::abort();
  return fd;
}

void SetOption(int fd, int level, int option) {
  const int on = 1;
  setsockopt(fd, level, option, &on, sizeof(on));
}

void Reset(int fd) {
  const linger at_once = {1, 0};
  setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
  close(fd);
}

bool IsReadable(const pollfd& polled) {
  return (polled.revents & (POLLIN | POLLHUP | POLLERR)) != 0;
}

}  // namespace

TcpRelay::TcpRelay(int server_port)
    : server_port_(server_port), listener_(MakeSocket()) {
  sockaddr_in address = Loopback(0);
  socklen_t size = sizeof(address);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (bind(listener_, generic, size) != 0 || listen(listener_, 16) != 0 ||
      getsockname(listener_, generic, &size) != 0 ||
      pipe2(commands_, O_CLOEXEC) != 0) {
    std::abort();
  }
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { Run(); });
}

TcpRelay::~TcpRelay() {
  Command('q');
  thread_.join();
  close(listener_);
  close(commands_[0]);
  close(commands_[1]);
}

std::string TcpRelay::target() const {
  return absl::StrCat("127.0.0.1:", port_);
}

void TcpRelay::Command(char command) {
  if (write(commands_[1], &command, 1) != 1) std::abort();
}

void TcpRelay::Run() {
  for (;;) {
    std::vector<pollfd> polled = {{commands_[0], POLLIN, 0},
                                  {listener_, POLLIN, 0}};
    for (const Pair& pair : pairs_) {
      // A negative descriptor is passed over.
      polled.push_back({pair.passes_requests ? pair.client : -1, POLLIN, 0});
      polled.push_back({pair.passes_answers ? pair.server : -1, POLLIN, 0});
    }
    poll(polled.data(), polled.size(), -1);
    std::vector<Pair> living;
    for (size_t i = 0; i < pairs_.size(); ++i) {
      const Pair& pair = pairs_[i];
      const bool lives =
          (!IsReadable(polled[2 + 2 * i]) || Pass(pair.client, pair.server)) &&
          (!IsReadable(polled[3 + 2 * i]) || Pass(pair.server, pair.client));
      if (lives) {
        living.push_back(pair);
      } else {
        Reset(pair.client);
        Reset(pair.server);
      }
    }
    pairs_ = living;
    if (IsReadable(polled[1])) Accept();
    if (!IsReadable(polled[0])) continue;
    char command = 0;
    if (read(commands_[0], &command, 1) != 1) std::abort();
    Obey(command);
    if (command == 'q') return;
  }
}

void TcpRelay::Obey(char command) {
  if (command == 'd' || command == 'f') {
    for (Pair& pair : pairs_) {
      pair.passes_answers = false;
      if (command == 'f') pair.passes_requests = false;
    }
    return;
  }
  for (const Pair& pair : pairs_) {
    Reset(pair.client);
    Reset(pair.server);
  }
  pairs_.clear();
}

void TcpRelay::Accept() {
  Pair pair;
  pair.client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  if (pair.client < 0) return;
  pair.server = MakeSocket();
  const sockaddr_in address = Loopback(server_port_);
  if (connect(pair.server, reinterpret_cast<const sockaddr*>(&address),
              sizeof(address)) != 0) {
    Reset(pair.client);
    Reset(pair.server);
    return;
  }
  for (int fd : {pair.client, pair.server}) {
    SetOption(fd, IPPROTO_TCP, TCP_NODELAY);
  }
  pairs_.push_back(pair);
}

bool TcpRelay::Pass(int from, int to) {
  char buffer[1 << 16];
  const ssize_t size = read(from, buffer, sizeof(buffer));
  if (size <= 0) return false;
  for (ssize_t sent = 0; sent < size;) {
    const ssize_t count = send(to, buffer + sent, size - sent, MSG_NOSIGNAL);
    if (count <= 0) return false;
    sent += count;
  }
  return true;
}

}  // namespace gelenk::testing
