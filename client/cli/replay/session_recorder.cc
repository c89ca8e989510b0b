#include "client/cli/replay/session_recorder.h"

#include <utility>

#include "gelenk/client/frame_merge.h"

namespace gelenk::cli {

absl::StatusOr<std::unique_ptr<SessionRecorder>> SessionRecorder::Start(
    client::Connection& connection, const client::SessionSpec& spec,
    const std::string& path) {
  const absl::StatusOr<v1::ServerInfo> server = connection.Call(
      &v1::KinematicsService::Stub::GetServerInfo, v1::GetServerInfoRequest());
  if (!server.ok()) return server.status();
  auto writer = SessionLogWriter::Open(path, *server, spec);
  if (!writer.ok()) return writer.status();
  return std::unique_ptr<SessionRecorder>(
      new SessionRecorder(*std::move(writer), spec.session.session()));
}

SessionRecorder::SessionRecorder(std::unique_ptr<SessionLogWriter> writer,
                                 const v1::Session& session)
    : completes_(!session.has_conditioning()),
      writer_(std::move(writer)),
      goals_(session) {}

void SessionRecorder::NoteSent(v1::TargetFrame frame) {
  std::lock_guard<std::mutex> lock(mutex_);
  unanswered_.push_back(std::move(frame));
}

absl::Status SessionRecorder::NoteAnswer(const v1::PoseFrame& answer) {
  std::lock_guard<std::mutex> lock(mutex_);
  v1::TargetFrame solved;
  bool has_any = false;
  bool merges = true;
  while (!unanswered_.empty() &&
         unanswered_.front().sequence_number() <= answer.sequence_number()) {
    if (!has_any) {
      solved = std::move(unanswered_.front());
    } else if (!client::Merge(unanswered_.front(), &solved)) {
      merges = false;
    }
    has_any = true;
    unanswered_.pop_front();
  }
  if (!has_any || answer.status().code() != 0) return absl::OkStatus();
  if (!merges) {
    return absl::FailedPreconditionError(
        "frames that change goals were merged with others: record with one "
        "solve for every frame");
  }
  if (completes_) {
    goals_.Complete({.weights = true, .place = true}, &solved);
  }
  goals_.Apply(solved);
  return writer_->Append(solved, answer);
}

absl::Status SessionRecorder::Finish() {
  std::lock_guard<std::mutex> lock(mutex_);
  return writer_->Close();
}

}  // namespace gelenk::cli
