// A real server in a process of its own, to be killed.
#ifndef GELENK_TESTS_TESTING_SERVER_PROCESS_H_
#define GELENK_TESTS_TESTING_SERVER_PROCESS_H_

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"

namespace gelenk::testing {

// Listens on loopback, on a free port at first and on the same one afterwards.
// Ends with this object, and five minutes after its start whatever becomes of
// the test. Not thread-safe.
class ServerProcess {
 public:
  // `arguments` follow --listen and --port-file.
  ServerProcess(std::string program, std::vector<std::string> arguments = {});
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  // Returns when it listens; DEADLINE_EXCEEDED when it does not within 20 s,
  // UNAVAILABLE when it ended instead.
  absl::Status Start();

  // 127.0.0.1:<port>
  std::string target() const;
  int port() const { return port_; }
  bool is_running() const { return pid_ > 0; }
  // Memory that the process holds, as the kernel counts it; 0 when it does not
  // run.
  int64_t resident_bytes() const;

  // SIGKILL, and waits for the end.
  void Kill();
  // SIGTERM, and waits for the end; the exit code, or -1 when it had to be
  // killed after `patience`.
  int Terminate(absl::Duration patience);

 private:
  bool WaitForEnd(absl::Duration patience, int* exit_code);

  const std::string program_;
  const std::vector<std::string> arguments_;
  std::string port_file_;
  int port_ = 0;
  pid_t pid_ = -1;
};

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_SERVER_PROCESS_H_
