// Solves a log again and compares.
#ifndef CLIENT_CLI_REPLAY_REPLAYER_H_
#define CLIENT_CLI_REPLAY_REPLAYER_H_

#include <Eigen/Core>
#include <functional>
#include <memory>

#include "absl/status/statusor.h"
#include "client/cli/replay/session_log.h"
#include "gelenk/client/connection.h"

namespace gelenk::cli {

struct ReplayResult {
  // What solved it again.
  v1::ServerInfo server;
  // Index of the first frame whose pose is not that of the log bit by bit, -1
  // where all are; and the pose that came out there.
  int first_difference = -1;
  Eigen::VectorXd positions;
};

// Bits are promised on one build and one level of the instruction set.
bool IsOfOneLevel(const v1::ServerInfo& a, const v1::ServerInfo& b);

// Creates the log's skeletons and session under names of its own, streams the
// frames, every one solved, up to the first that differs, and deletes what it
// created. Errors: those of the service, or of a frame, naming it.
absl::StatusOr<ReplayResult> ReplaySession(
    const std::shared_ptr<client::Connection>& connection,
    const SessionLog& log, const std::function<void(int)>& report_progress);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_REPLAY_REPLAYER_H_
