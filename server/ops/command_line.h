// The flags of gelenkd. Each that has a value or switches something on can also
// be given by the environment: GELENKD_MAX_SESSIONS for --max-sessions. A flag
// is stronger.
#ifndef GELENK_SERVER_OPS_COMMAND_LINE_H_
#define GELENK_SERVER_OPS_COMMAND_LINE_H_

#include <optional>
#include <string>

#include "absl/time/time.h"
#include "server/options.h"

namespace gelenk::server {

struct CommandLine {
  // Ask the server that listens at server.listen how it is, instead of being
  // one.
  bool health_check = false;
  ServerOptions server;
  // Receives the port once the server listens.
  std::string port_file;
  std::string log_level = "info";
  // How long streams have to leave after SIGTERM.
  absl::Duration drain = absl::Seconds(20);
};

// An exit code when the process is to end right away (help, version, mistakes,
// which have been printed).
std::optional<int> ParseCommandLine(int argc, char** argv,
                                    CommandLine& command_line);

// Writes the port of `address` and a line break, so that a reader sees all or
// nothing.
bool WritePortFile(const std::string& path, const std::string& address);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_OPS_COMMAND_LINE_H_
