// What a session was asked, frame by frame, and what it answered: a file from
// which it is solved again and compared bit by bit.
//
// The file begins with kSessionLogMagic. Messages of gelenk.v1 follow, each
// behind its length in bytes (a varint): ServerInfo, CreateSkeletonRequest, the
// same for the body that a session with retargeting follows (empty without
// one), CreateSessionRequest; then for every frame that was solved a
// TargetFrame and its PoseFrame; at the end a length of 0.
//
// Frames are effective ones: what frames merged, and what goals keep from the
// frames before, is filled in. Frames whose answer is an error are left out:
// they changed nothing.
#ifndef CLIENT_CLI_REPLAY_SESSION_LOG_H_
#define CLIENT_CLI_REPLAY_SESSION_LOG_H_

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/client/session_spec.h"
#include "gelenk/motion/frame_log.h"
#include "gelenk/v1/kinematics_service.pb.h"
#include "gelenk/v1/session_service.pb.h"

namespace gelenk::cli {

inline constexpr absl::string_view kSessionLogMagic = "gelenk session log 1\n";
// As many as a clip may be sampled into.
inline constexpr int kMaxLoggedFrames = 1'000'000;
// What a client takes from a server at most.
inline constexpr uint32_t kMaxLoggedMessageBytes = 64 << 20;
// It is held in memory.
inline constexpr size_t kMaxLogBytes = size_t{1} << 30;

struct SessionLogLimits {
  int max_frames = kMaxLoggedFrames;
  size_t max_bytes = kMaxLogBytes;
};

struct SessionLog {
  // What solved it.
  v1::ServerInfo server;
  // Its skeletons and session: ids are those of the recording.
  client::SessionSpec spec;
  // With the number, time, effective frame and answered pose of each.
  FrameLog<v1::TargetFrame> frames{kMaxLoggedFrames};
};

// INVALID_ARGUMENT naming the byte where `bytes` is no log, or ends too early;
// RESOURCE_EXHAUSTED beyond the limits. Cost: linear.
absl::StatusOr<SessionLog> ParseSessionLog(absl::string_view bytes,
                                           const SessionLogLimits& limits = {});

// Errors name the file.
absl::StatusOr<SessionLog> ReadSessionLog(const std::string& path);

// Writes a log frame by frame. Without Close the file has no end and is
// refused. Not thread-safe.
class SessionLogWriter {
 public:
  // Replaces what was at `path`. Errors name it.
  static absl::StatusOr<std::unique_ptr<SessionLogWriter>> Open(
      const std::string& path, const v1::ServerInfo& server,
      const client::SessionSpec& spec, const SessionLogLimits& limits = {});

  // RESOURCE_EXHAUSTED where the log is full, or for a frame that no reader
  // takes: nothing of it is written, and Close makes a log of those before.
  absl::Status Append(const v1::TargetFrame& effective_frame,
                      const v1::PoseFrame& answer);
  absl::Status Close();

 private:
  struct CloseFile {
    void operator()(FILE* file) const { std::fclose(file); }
  };

  SessionLogWriter(std::string path, FILE* file,
                   const SessionLogLimits& limits);
  // All of them or none, and leaves room for the end.
  absl::Status WriteMessages(
      absl::Span<const google::protobuf::MessageLite* const> messages);
  absl::Status Write(absl::string_view bytes);
  absl::Status Full(absl::string_view limit) const;

  const std::string path_;
  const SessionLogLimits limits_;
  const std::unique_ptr<FILE, CloseFile> file_;
  size_t byte_count_ = 0;
  int frame_count_ = 0;
};

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_REPLAY_SESSION_LOG_H_
