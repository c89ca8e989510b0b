// A TCP connection without a protocol on it, for clients that are broken.
#ifndef GELENK_TESTS_TESTING_RAW_SOCKET_H_
#define GELENK_TESTS_TESTING_RAW_SOCKET_H_

#include <string>

#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace gelenk::testing {

// To a port on loopback. Not thread-safe.
class RawSocket {
 public:
  explicit RawSocket(int port);
  ~RawSocket();
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;

  // False when not all of it is taken, at once.
  bool Send(absl::string_view bytes);
  // What has come, at least one byte; empty when the other side closed, or
  // nothing came within `patience`.
  std::string Receive(absl::Duration patience);
  // Reads until the other side closes; false when it has not after `patience`.
  bool WaitForClose(absl::Duration patience);
  // Goes away without a word of goodbye.
  void Reset();

 private:
  int fd_ = -1;
};

// The bytes of one HTTP/2 frame. `type` and `flags` as RFC 9113 numbers them.
std::string Http2Frame(int type, int flags, int stream,
                       absl::string_view payload);

// What every HTTP/2 client says first: the preface and empty settings.
std::string Http2Preface();

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_RAW_SOCKET_H_
