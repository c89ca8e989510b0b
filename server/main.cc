// gelenkd: the server.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <string>

#include "absl/time/time.h"
#include "server/ops/command_line.h"
#include "server/ops/health_check.h"
#include "server/ops/logging.h"
#include "server/ops/stop_signal.h"
#include "server/rpc/message_log.h"
#include "server/server.h"
#include "server/version.h"

namespace gelenk::server {
namespace {

// A container's health check has no more time than a few seconds.
constexpr absl::Duration kHealthCheckPatience = absl::Seconds(3);

int RunHealthCheck(const CommandLine& command_line) {
  const absl::Status status = CheckHealth(
      LocalTarget(command_line.server.listen), kHealthCheckPatience);
  if (status.ok()) return 0;
  spdlog::error("not healthy: {}", std::string(status.message()));
  return 1;
}

int Run(const CommandLine& command_line) {
  // Before the first thread, so that none of them takes the signal.
  StopSignal stop;
  absl::StatusOr<std::unique_ptr<Server>> server =
      Server::Start(command_line.server);
  if (!server.ok()) {
    spdlog::error("cannot start: {}", std::string(server.status().message()));
    return 1;
  }
  if (!command_line.port_file.empty() &&
      !WritePortFile(command_line.port_file, (*server)->address())) {
    spdlog::error("cannot write port_file {}", command_line.port_file);
    return 1;
  }
  spdlog::info(
      "gelenkd {} listens on {}, solves with {}", Version(),
      (*server)->address(),
      std::string(InstructionSetName(command_line.server.instruction_set)));
  spdlog::warn("sessions and skeletons are in memory: a restart forgets them");

  const int signal = stop.Wait();
  spdlog::info("signal {}: draining {} streams, at most {}", signal,
               (*server)->stream_count(),
               absl::FormatDuration(command_line.drain));
  (*server)->Drain(command_line.drain);
  spdlog::info("bye");
  return 0;
}

}  // namespace
}  // namespace gelenk::server

int main(int argc, char** argv) {
  gelenk::server::CommandLine command_line;
  if (const auto exit_code =
          gelenk::server::ParseCommandLine(argc, argv, command_line)) {
    return *exit_code;
  }
  gelenk::server::StartLogging(command_line.log_level);
  gelenk::server::DropMessageLog();
  return command_line.health_check
             ? gelenk::server::RunHealthCheck(command_line)
             : gelenk::server::Run(command_line);
}
