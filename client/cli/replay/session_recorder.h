// Listens to a stream of frames and writes its log: see session_log.h.
#ifndef CLIENT_CLI_REPLAY_SESSION_RECORDER_H_
#define CLIENT_CLI_REPLAY_SESSION_RECORDER_H_

#include <deque>
#include <memory>
#include <mutex>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/cli/replay/session_log.h"
#include "gelenk/client/connection.h"
#include "gelenk/client/effective_goals.h"
#include "gelenk/client/session_spec.h"

namespace gelenk::cli {

// Of one session, whose slot is 0. Thread-safe: frames and answers may come
// from threads of their own.
class SessionRecorder {
 public:
  // Asks the server what it is; replaces what was at `path`, which errors name.
  static absl::StatusOr<std::unique_ptr<SessionRecorder>> Start(
      client::Connection& connection, const client::SessionSpec& spec,
      const std::string& path);

  // Before the frame is sent.
  void NoteSent(v1::TargetFrame frame);
  // FAILED_PRECONDITION where frames that change goals were merged: what was
  // solved is then no single frame. Else errors of the file.
  absl::Status NoteAnswer(const v1::PoseFrame& answer);
  // Ends the file.
  absl::Status Finish();

 private:
  SessionRecorder(std::unique_ptr<SessionLogWriter> writer,
                  const v1::Session& session);

  // Frames as they were sent tell which ones are missing.
  const bool completes_;
  std::mutex mutex_;
  const std::unique_ptr<SessionLogWriter> writer_ ABSL_PT_GUARDED_BY(mutex_);
  // As the answers so far have left them.
  client::EffectiveGoals goals_ ABSL_GUARDED_BY(mutex_);
  std::deque<v1::TargetFrame> unanswered_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_REPLAY_SESSION_RECORDER_H_
