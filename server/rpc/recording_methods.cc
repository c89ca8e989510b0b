#include "server/rpc/recording_methods.h"

#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/motion/recorder.h"
#include "server/rpc/clip_creation.h"
#include "server/rpc/clip_message.h"
#include "server/rpc/find_session.h"
#include "server/rpc/unary_call.h"

namespace gelenk::server {
namespace {

using Service = v1::MotionService::AsyncService;

// Ten minutes at 60 Hz.
constexpr int kDefaultFrames = 36'000;

absl::Status StartRecording(ServiceState& state,
                            const v1::StartRecordingRequest& request,
                            v1::Recording* response) {
  const auto session = FindSession(state, "session", request.session());
  if (!session.ok()) return session.status();
  const int frames = request.max_frame_count() == 0 ? kDefaultFrames
                                                    : request.max_frame_count();
  if (frames < 1 || frames > kDefaultMaxRecordedFrames) {
    Violations violations;
    violations.Add("max_frame_count",
                   absl::StrCat("want 1 to ", kDefaultMaxRecordedFrames,
                                ", or 0, got ", frames));
    return violations.ToStatus();
  }
  const std::shared_ptr<const Skeleton>& skeleton =
      (*session)->trees().skeleton();
  const int64_t bytes = int64_t{frames} * (skeleton->position_count() + 1) *
                        static_cast<int64_t>(sizeof(double));
  const int64_t most = state.options.limits.max_recording_bytes;
  auto reserved =
      std::make_unique<ReservedBytes>(state.recording_bytes, bytes, most);
  if (!reserved->granted()) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "max_frame_count: %d poses take %d bytes, all recordings together may "
        "take %d",
        frames, bytes, most));
  }
  absl::Status status =
      (*session)->StartRecording(std::make_shared<SessionRecording>(
          skeleton, frames, std::move(reserved)));
  if (!status.ok()) return status;
  response->set_session(request.session());
  response->set_max_frame_count(frames);
  return absl::OkStatus();
}

// The clip of a recording that has ended.
absl::StatusOr<StoredClip> StoreRecording(
    ServiceState& state, const v1::StopRecordingRequest& request,
    const Session& session, const SessionRecording& recording) {
  absl::StatusOr<MotionClip> clip = recording.ToClip(request.display_name());
  if (!clip.ok()) return clip.status();
  StoredClip stored{.display_name = request.display_name(),
                    .skeleton_name = session.skeleton_name(),
                    .clip = *std::move(clip)};
  if (recording.left_out_count() > 0) {
    stored.warnings.push_back(
        absl::StrCat(recording.left_out_count(),
                     " poses left out: the recording was full, or their time "
                     "was not after the one before"));
  }
  return StoreClip(state, {request.clip_id(), request.request_id()},
                   std::move(stored));
}

absl::Status StopRecording(ServiceState& state,
                           const v1::StopRecordingRequest& request,
                           v1::Clip* response) {
  if (absl::Status status =
          CheckNewClip("clip_id", request.clip_id(), request.request_id());
      !status.ok()) {
    return status;
  }
  if (AnswerEarlier(state, request.request_id(), response)) {
    return absl::OkStatus();
  }
  const auto session = FindSession(state, "session", request.session());
  if (!session.ok()) return session.status();
  absl::StatusOr<std::shared_ptr<SessionRecording>> recording =
      (*session)->StopRecording();
  if (!recording.ok()) return recording.status();
  if (request.discard()) return absl::OkStatus();
  const absl::StatusOr<StoredClip> stored =
      StoreRecording(state, request, **session, **recording);
  if (!stored.ok()) {
    // It goes on, so that nothing is lost for want of room or of a better name.
    (*session)->StartRecording(*std::move(recording)).IgnoreError();
    return stored.status();
  }
  ToProto(*stored, response);
  return absl::OkStatus();
}

}  // namespace

void ServeRecordings(Service* service, ServiceState* state, IoThread* thread) {
  ServeUnary(
      service, &Service::RequestStartRecording,
      [state](IkSolver&, const v1::StartRecordingRequest& request,
              v1::Recording* response) {
        return StartRecording(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestStopRecording,
      [state](IkSolver&, const v1::StopRecordingRequest& request,
              v1::Clip* response) {
        return StopRecording(*state, request, response);
      },
      state, thread);
}

}  // namespace gelenk::server
