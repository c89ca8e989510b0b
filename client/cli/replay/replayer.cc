#include "client/cli/replay/replayer.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/made_session.h"
#include "client/cli/unique_id.h"
#include "gelenk/client/session_stream.h"

namespace gelenk::cli {
namespace {

// Frames under way at a time.
constexpr int kBatch = 32;
constexpr absl::Duration kTimeout = absl::Seconds(30);
// A command that was killed leaves its session behind for no longer.
constexpr int kIdleSeconds = 60;

// What the log created, under names that are free.
client::SessionSpec SpecOf(const SessionLog& log) {
  client::SessionSpec spec = log.spec;
  const std::string id = UniqueId();
  spec.skeleton.set_skeleton_id(id);
  spec.skeleton.set_request_id(id);
  spec.session.set_session_id(id);
  spec.session.set_request_id(id);
  v1::Session* session = spec.session.mutable_session();
  session->clear_name();
  session->clear_skeleton();
  session->clear_affinity_key();
  session->mutable_idle_ttl()->set_seconds(kIdleSeconds);
  if (spec.source_skeleton.has_skeleton()) {
    const std::string source_id = absl::StrCat(id, "-source");
    spec.source_skeleton.set_skeleton_id(source_id);
    spec.source_skeleton.set_request_id(source_id);
    session->mutable_retargeting()->clear_source_skeleton();
  }
  spec.frame_policy = v1::FRAME_POLICY_EVERY_FRAME;
  // Frames come at a pace of their own.
  if (session->has_conditioning()) {
    session->mutable_conditioning()->clear_fill_interval();
  }
  return spec;
}

// Solves frame after frame, some of them under way at a time.
class Solver {
 public:
  Solver(const SessionLog& log, client::SessionStream& stream)
      : frames_(log.frames.frames()), stream_(stream) {}

  absl::StatusOr<Eigen::VectorXd> Next() {
    const LoggedFrame<v1::TargetFrame>& frame = frames_[solved_];
    for (; sent_ < std::min(solved_ + kBatch, frames_.size()); ++sent_) {
      v1::TargetFrame input = frames_[sent_].input;
      input.set_slot(0);
      absl::Status status = stream_.Send(std::move(input), kTimeout);
      if (!status.ok()) return status;
    }
    const auto answer = stream_.Receive(kTimeout);
    if (!answer.ok()) return answer.status();
    if (!answer->has_value()) {
      return absl::DeadlineExceededError(
          absl::StrCat("frame ", solved_, ": the server does not answer"));
    }
    const v1::PoseFrame& pose = **answer;
    if (pose.status().code() != 0) {
      return absl::Status(
          static_cast<absl::StatusCode>(pose.status().code()),
          absl::StrCat("frame ", solved_, ": ", pose.status().message()));
    }
    if (pose.sequence_number() != frame.sequence_number) {
      return absl::InternalError(absl::StrCat(
          "frame ", solved_, ": the server answers sequence_number ",
          pose.sequence_number(), ", want ", frame.sequence_number));
    }
    ++solved_;
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
        pose.pose().positions().data(), pose.pose().positions_size()));
  }

 private:
  const std::vector<LoggedFrame<v1::TargetFrame>>& frames_;
  client::SessionStream& stream_;
  size_t sent_ = 0;
  size_t solved_ = 0;
};

absl::Status Compare(const SessionLog& log, client::SessionStream& stream,
                     const std::function<void(int)>& report_progress,
                     ReplayResult* result) {
  Solver solver(log, stream);
  absl::Status status;
  int done = 0;
  result->first_difference =
      log.frames.Replay([&](const LoggedFrame<v1::TargetFrame>&) {
        if (!status.ok()) return Eigen::VectorXd();
        absl::StatusOr<Eigen::VectorXd> positions = solver.Next();
        status = positions.status();
        if (!status.ok()) return Eigen::VectorXd();
        report_progress(++done);
        result->positions = *std::move(positions);
        return result->positions;
      });
  return status;
}

}  // namespace

bool IsOfOneLevel(const v1::ServerInfo& a, const v1::ServerInfo& b) {
  return a.instruction_set() == b.instruction_set() && a.build() == b.build();
}

absl::StatusOr<ReplayResult> ReplaySession(
    const std::shared_ptr<client::Connection>& connection,
    const SessionLog& log, const std::function<void(int)>& report_progress) {
  ReplayResult result;
  absl::StatusOr<v1::ServerInfo> server = connection->Call(
      &v1::KinematicsService::Stub::GetServerInfo, v1::GetServerInfoRequest());
  if (!server.ok()) return server.status();
  result.server = *std::move(server);
  const client::SessionSpec spec = SpecOf(log);
  client::SessionStreamOptions options;
  options.window = kBatch;
  options.max_frames_per_message = kBatch;
  auto stream = client::SessionStream::Open(connection, options, {spec});
  absl::Status status = stream.status();
  if (status.ok()) {
    status = Compare(log, **stream, report_progress, &result);
    stream->reset();
  }
  DeleteMade(*connection, spec);
  if (!status.ok()) return status;
  return result;
}

}  // namespace gelenk::cli
