#include "client/cli/play/clip_player.h"

#include <atomic>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/cli/made_session.h"
#include "client/cli/play/target_frame.h"
#include "client/cli/replay/session_recorder.h"
#include "client/cli/unique_id.h"
#include "client/cli/uploaded_skeleton.h"
#include "convert/skeleton.h"
#include "gelenk/client/session_stream.h"

namespace gelenk::cli {
namespace {

constexpr absl::Duration kReceiveTimeout = absl::Milliseconds(200);
constexpr absl::Duration kCloseTimeout = absl::Seconds(10);

client::SessionSpec SpecFor(const PlayerOptions& options,
                            const Playback& playback) {
  client::SessionSpec spec;
  const std::string id = UniqueId();
  spec.skeleton.set_skeleton_id(id);
  spec.skeleton.set_request_id(id);
  convert::ToProto(*playback.skeleton, spec.skeleton.mutable_skeleton());
  spec.skeleton.mutable_skeleton()->set_display_name(playback.clip_name);
  spec.session.set_session_id(id);
  spec.session.set_request_id(id);
  *spec.session.mutable_session() = SessionFor(playback);
  spec.frame_policy = options.policy;
  return spec;
}

// Sends the frames of a clip from a thread of its own.
class Sender {
 public:
  // `recorder` may be null.
  Sender(const Playback& playback, std::optional<double> fps,
         SessionRecorder* recorder, client::SessionStream& stream)
      : playback_(playback),
        frame_interval_(fps ? absl::Seconds(1 / *fps) : absl::ZeroDuration()),
        recorder_(recorder),
        stream_(stream),
        thread_([this] { status_ = Run(); }) {}

  ~Sender() { Stop().IgnoreError(); }

  // Ends the thread after the frame under way. An error is what had stopped it.
  absl::Status Stop() {
    stopped_ = true;
    if (thread_.joinable()) thread_.join();
    return status_;
  }

  bool failed() const { return failed_; }

 private:
  absl::Status Run() {
    TargetFrameWriter writer(playback_);
    const absl::Time start = absl::Now();
    for (int frame = 0; frame < playback_.frame_count() && !stopped_; ++frame) {
      absl::SleepFor(start + frame * frame_interval_ - absl::Now());
      v1::TargetFrame message = writer.Write(frame);
      if (recorder_ != nullptr) recorder_->NoteSent(message);
      absl::Status status = stream_.Send(std::move(message));
      if (status.ok()) continue;
      failed_ = true;
      return status;
    }
    return absl::OkStatus();
  }

  const Playback& playback_;
  const absl::Duration frame_interval_;
  SessionRecorder* const recorder_;
  client::SessionStream& stream_;
  std::atomic<bool> stopped_ = false;
  std::atomic<bool> failed_ = false;
  absl::Status status_;
  // Last: runs on all of the above.
  std::thread thread_;
};

// Takes answers until the one of the last frame.
absl::Status ReceiveAll(const Sender& sender,
                        const std::function<void(int)>& report_progress,
                        SessionRecorder* recorder,
                        client::SessionStream& stream, Playback* playback) {
  for (int64_t last = 0; last < playback->frame_count() && !sender.failed();) {
    const auto answer = stream.Receive(kReceiveTimeout);
    if (!answer.ok()) return answer.status();
    if (!answer->has_value()) continue;
    last = (*answer)->sequence_number();
    absl::Status status = TakeAnswer(**answer, playback);
    if (status.ok() && recorder != nullptr) {
      status = recorder->NoteAnswer(**answer);
    }
    if (!status.ok()) return status;
    report_progress(static_cast<int>(last));
  }
  return absl::OkStatus();
}

// Frames without an answer stay as the one before them.
void HoldPoses(Playback* playback) {
  for (int frame = 0; frame < playback->frame_count(); ++frame) {
    if (playback->answers[frame].answered) continue;
    if (frame == 0) {
      playback->answered_poses.col(0) = playback->skeleton->rest_positions();
    } else {
      playback->answered_poses.col(frame) =
          playback->answered_poses.col(frame - 1);
    }
  }
}

absl::Status Stream(const PlayerOptions& options,
                    const std::function<void(int)>& report_progress,
                    SessionRecorder* recorder, client::SessionStream& stream,
                    Playback* playback) {
  const absl::Time start = absl::Now();
  Sender sender(*playback, options.fps, recorder, stream);
  absl::Status status =
      ReceiveAll(sender, report_progress, recorder, stream, playback);
  playback->elapsed = absl::Now() - start;
  if (!status.ok()) {
    // Releases a sender that is held by a full window.
    stream.Close(absl::ZeroDuration()).IgnoreError();
  }
  status.Update(sender.Stop());
  if (!status.ok()) return status;
  return stream.Close(kCloseTimeout);
}

}  // namespace

absl::Status PlayClip(const std::shared_ptr<client::Connection>& connection,
                      const PlayerOptions& options,
                      const std::function<void(int)>& report_progress,
                      Playback* playback) {
  playback->answers.assign(playback->clip_poses.cols(), Answer());
  playback->answered_poses.resizeLike(playback->clip_poses);
  client::SessionStreamOptions stream_options;
  stream_options.window = options.batch;
  stream_options.max_frames_per_message = options.batch;
  const client::SessionSpec spec = SpecFor(options, *playback);
  std::unique_ptr<SessionRecorder> recorder;
  if (!options.record_path.empty()) {
    auto started =
        SessionRecorder::Start(*connection, spec, options.record_path);
    if (!started.ok()) return started.status();
    recorder = *std::move(started);
  }

  auto stream = client::SessionStream::Open(connection, stream_options, {spec});
  absl::Status status = stream.status();
  if (status.ok()) {
    status =
        Stream(options, report_progress, recorder.get(), **stream, playback);
    const client::StreamStatistics statistics = (*stream)->statistics();
    playback->reconnects = statistics.reconnects;
    playback->round_trip = {statistics.round_trips.Quantile(0.5),
                            statistics.round_trips.Quantile(0.99),
                            statistics.round_trips.Quantile(1)};
    stream->reset();
  }
  DeleteMade(*connection, spec);
  // What was played until then can be replayed also where it broke off.
  if (recorder != nullptr) status.Update(recorder->Finish());
  if (status.ok()) HoldPoses(playback);
  return status;
}

}  // namespace gelenk::cli
