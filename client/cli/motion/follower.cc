#include "client/cli/motion/follower.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/made_session.h"
#include "client/cli/replay/session_recorder.h"
#include "client/cli/unique_id.h"
#include "convert/geometry.h"
#include "convert/joint_map.h"
#include "convert/pose.h"
#include "convert/retargeting.h"
#include "convert/skeleton.h"
#include "gelenk/client/session_stream.h"
#include "gelenk/client/status.h"

namespace gelenk::cli {
namespace {

// Frames under way at a time.
constexpr int kBatch = 32;
constexpr absl::Duration kTimeout = absl::Seconds(30);
constexpr int kTimeToLive_s = 120;

void SetSkeleton(const std::string& id, const Skeleton& skeleton,
                 v1::CreateSkeletonRequest& request) {
  request.set_skeleton_id(id);
  request.set_request_id(id);
  convert::ToProto(skeleton, request.mutable_skeleton());
}

void SetCalibration(const FollowedBody& body, v1::BodyCalibration& proto) {
  if (body.frames == nullptr) return;
  const Eigen::MatrixXd& poses = *body.frames;
  const Eigen::Index most = convert::kMaxCalibrationNumbers / poses.rows();
  const Eigen::Index size = std::min(most, poses.cols()) * poses.rows();
  proto.mutable_positions()->Assign(poses.data(), poses.data() + size);
  proto.set_frame_time_s(body.frame_time_s);
  proto.set_first_frame(body.first_frame);
}

// What all sessions on `target` have.
client::SessionSpec SpecOn(const FollowedBody& target,
                           absl::Span<const JointMapOverride> source_roles) {
  client::SessionSpec spec;
  const std::string id = UniqueId();
  SetSkeleton(id, *target.skeleton, spec.skeleton);
  spec.session.set_session_id(id);
  spec.session.set_request_id(id);
  v1::Session* session = spec.session.mutable_session();
  session->mutable_idle_ttl()->set_seconds(kTimeToLive_s);
  v1::Retargeting* retargeting = session->mutable_retargeting();
  *retargeting->mutable_joint_map() =
      convert::ToProto(source_roles, target.roles);
  SetCalibration(target, *retargeting->mutable_target_calibration());
  spec.frame_policy = v1::FRAME_POLICY_EVERY_FRAME;
  return spec;
}

// An answer as a pose of `skeleton`.
absl::StatusOr<Eigen::VectorXd> PoseOf(const v1::PoseFrame& answer,
                                       const Skeleton& skeleton) {
  if (answer.status().code() != 0) {
    return absl::Status(static_cast<absl::StatusCode>(answer.status().code()),
                        absl::StrCat("frame ", answer.sequence_number(), ": ",
                                     answer.status().message()));
  }
  return convert::FromProto(skeleton, answer.pose());
}

// `recorder` may be null.
absl::StatusOr<Eigen::MatrixXd> Stream(client::SessionStream& stream,
                                       const BodyFile& source,
                                       const Skeleton& target,
                                       SessionRecorder* recorder) {
  const int count = static_cast<int>(source.positions.cols());
  Eigen::MatrixXd poses(target.position_count(), count);
  int sent = 0;
  for (int answered = 0; answered < count;) {
    for (; sent < std::min(answered + kBatch, count); ++sent) {
      v1::TargetFrame frame;
      convert::ToProto(source.positions.col(sent), frame.mutable_source_pose());
      frame.set_sequence_number(sent + 1);
      if (recorder != nullptr) recorder->NoteSent(frame);
      absl::Status status = stream.Send(std::move(frame), kTimeout);
      if (!status.ok()) return status;
    }
    const auto answer = stream.Receive(kTimeout);
    if (!answer.ok()) return answer.status();
    if (!answer->has_value()) {
      return absl::DeadlineExceededError("the server does not answer");
    }
    const absl::StatusOr<Eigen::VectorXd> pose = PoseOf(**answer, target);
    if (!pose.ok()) return pose.status();
    if (recorder != nullptr) {
      absl::Status status = recorder->NoteAnswer(**answer);
      if (!status.ok()) return status;
    }
    poses.col(answered++) = *pose;
  }
  const absl::Status closed = stream.Close(kTimeout);
  if (!closed.ok()) return closed;
  return poses;
}

}  // namespace

FollowedBody FollowedBodyOf(const BodyFile& file) {
  FollowedBody body = {file.model->skeleton, file.roles, file.frames,
                       file.frame_time_s, 0};
  if (file.frames != nullptr) {
    body.first_frame =
        static_cast<int>(file.frames->cols() - file.positions.cols());
  }
  return body;
}

client::SessionSpec FollowerSpec(const FollowedBody& source,
                                 const FollowedBody& target) {
  client::SessionSpec spec = SpecOn(target, source.roles);
  SetSkeleton(absl::StrCat(spec.session.session_id(), "-source"),
              *source.skeleton, spec.source_skeleton);
  v1::Retargeting* retargeting =
      spec.session.mutable_session()->mutable_retargeting();
  SetCalibration(source, *retargeting->mutable_source_calibration());
  if (source.frames != nullptr) {
    retargeting->set_frame_time_s(source.frame_time_s);
  }
  return spec;
}

client::SessionSpec TrackedSpec(const TrackedBody& source,
                                const FollowedBody& target) {
  client::SessionSpec spec = SpecOn(target, {});
  v1::Session* session = spec.session.mutable_session();
  v1::Trackers* trackers = session->mutable_retargeting()->mutable_trackers();
  trackers->set_height_m(source.height_m);
  for (size_t i = 0; i < source.tracker_ids.size(); ++i) {
    v1::Goal* goal = session->add_goals();
    goal->set_goal_id(source.tracker_ids[i]);
    goal->set_weight(0);
    goal->mutable_pose()->set_end_effector_id(target.skeleton->joint(0).id);
    if (source.t_pose.empty()) continue;
    v1::TrackerPlace* place = trackers->add_t_pose();
    place->set_goal_id(source.tracker_ids[i]);
    convert::ToProto(source.t_pose[i], place->mutable_world_pose());
  }
  return spec;
}

absl::StatusOr<Eigen::MatrixXd> FollowClip(
    const std::shared_ptr<client::Connection>& connection,
    const BodyFile& source, const BodyFile& target,
    const std::string& record_path) {
  const client::SessionSpec spec =
      FollowerSpec(FollowedBodyOf(source), FollowedBodyOf(target));
  std::unique_ptr<SessionRecorder> recorder;
  if (!record_path.empty()) {
    auto started = SessionRecorder::Start(*connection, spec, record_path);
    if (!started.ok()) return started.status();
    recorder = *std::move(started);
  }
  client::SessionStreamOptions options;
  options.window = kBatch;
  options.max_frames_per_message = kBatch;
  auto stream = client::SessionStream::Open(connection, options, {spec});
  absl::StatusOr<Eigen::MatrixXd> poses =
      stream.ok()
          ? Stream(**stream, source, *target.model->skeleton, recorder.get())
          : stream.status();
  if (stream.ok()) stream->reset();
  DeleteMade(*connection, spec);
  if (recorder != nullptr) {
    absl::Status finished = recorder->Finish();
    if (poses.ok() && !finished.ok()) return finished;
  }
  return poses;
}

}  // namespace gelenk::cli
