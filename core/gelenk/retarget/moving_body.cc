#include "gelenk/retarget/moving_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/motion/first_frame.h"
#include "gelenk/retarget/retarget_clip.h"

namespace gelenk {
namespace {

// The time steps of a motion and of the one it was made from differ by rounding
// of the file at most.
constexpr double kFrameTimeSlack = 1e-3;

// Cuts `longer` where it has more frames at its start than `shorter` because
// that one left them out: as a filter does with the way out of a first frame,
// or as frame 0 was taken for no motion in one of the two only.
void CutToPair(MovingBody& longer, const MovingBody& shorter) {
  const Eigen::Index frames = shorter.positions.cols();
  const Eigen::Index extra = longer.positions.cols() - frames;
  if (frames == 0 || extra <= 0 ||
      (extra != longer.way_frames && extra != shorter.left_out)) {
    return;
  }
  longer.positions = Eigen::MatrixXd(longer.positions.rightCols(frames));
  longer.notes.push_back(absl::StrCat(
      extra, extra == 1 ? " frame" : " frames",
      " at the start left out: the other motion does not have them"));
}

absl::StatusOr<Eigen::MatrixXd> RetargetFrames(
    const MovingBody& source, std::shared_ptr<const BodyModel> target,
    const RetargetOptions& options) {
  const int rows = target->skeleton->position_count();
  const auto retargeter =
      Retargeter::Create(source.model, std::move(target), options);
  if (!retargeter.ok()) return retargeter.status();
  Eigen::MatrixXd positions(rows, source.positions.cols());
  for (Eigen::Index f = 0; f < source.positions.cols(); ++f) {
    const absl::Status status =
        (*retargeter)->Retarget(source.positions.col(f), source.frame_time_s);
    if (!status.ok()) return status;
    positions.col(f) = (*retargeter)->positions();
  }
  return positions;
}

}  // namespace

absl::StatusOr<MovingBody> MakeMovingBody(
    std::shared_ptr<const Skeleton> skeleton, Eigen::MatrixXd frames,
    double frame_time_s, absl::Span<const JointMapOverride> overrides) {
  MovingBody body;
  int first = 0;
  std::optional<ClipView> view;
  if (frames.cols() > 0) {
    first = FindFirstFrameJump(*skeleton, frames).has_value() ? 1 : 0;
    body.frame_time_s = frame_time_s;
    body.left_out = first;
    body.way_frames =
        std::max(0, CountFramesBeforeMotion(*skeleton, frames) - first);
    view.emplace(ClipView{frames, frame_time_s, first});
  }
  const ClipView* clip = view ? &*view : nullptr;
  const absl::StatusOr<JointMap> map =
      ProposeJointMap(*skeleton, overrides, clip);
  if (!map.ok()) return map.status();
  absl::StatusOr<std::shared_ptr<const BodyModel>> model =
      MakeBodyModel(std::move(skeleton), *map, clip);
  if (!model.ok()) return model.status();
  body.model = *std::move(model);
  if (first == 1) {
    body.notes.emplace_back("frame 0 is no part of the motion and left out");
    body.positions = frames.rightCols(frames.cols() - 1);
  } else {
    body.positions = std::move(frames);
  }
  body.notes.insert(body.notes.end(), body.model->notes.begin(),
                    body.model->notes.end());
  return body;
}

std::vector<BodyPose> BodyPosesOf(const BodyModel& model,
                                  const Eigen::MatrixXd& positions) {
  std::vector<BodyPose> poses(positions.cols());
  WorldTransforms world_from_joints;
  for (Eigen::Index f = 0; f < positions.cols(); ++f) {
    ForwardKinematics(*model.skeleton, positions.col(f), world_from_joints);
    ReadBodyPose(model, world_from_joints, poses[f]);
  }
  return poses;
}

ContactLabels ContactsOf(const MovingBody& body,
                         absl::Span<const BodyPose> poses) {
  return LabelContacts(FootPointsOf(poses), body.frame_time_s,
                       FeetOf(*body.model));
}

void PairFrames(MovingBody& body, MovingBody& reference) {
  CutToPair(body, reference);
  CutToPair(reference, body);
}

absl::StatusOr<MeasuredMotion> MeasureBody(const MovingBody& body,
                                           const MovingBody* reference) {
  if (!body.has_motion()) {
    return absl::InvalidArgumentError("no motion to measure");
  }
  const std::vector<BodyPose> poses = BodyPosesOf(*body.model, body.positions);
  const BodyMotionView motion = {*body.model, poses, body.frame_time_s};
  MeasuredMotion measured;
  if (reference == nullptr) {
    measured.quality = MeasureMotion(motion, ContactsOf(body, poses));
    return measured;
  }
  if (reference->positions.cols() != body.positions.cols() ||
      std::abs(reference->frame_time_s - body.frame_time_s) >
          kFrameTimeSlack * body.frame_time_s) {
    return absl::InvalidArgumentError(
        absl::StrCat(body.positions.cols(), " frames of ", body.frame_time_s,
                     " s, the reference has ", reference->positions.cols(),
                     " of ", reference->frame_time_s, " s"));
  }
  const std::vector<BodyPose> source_poses =
      BodyPosesOf(*reference->model, reference->positions);
  const BodyMotionView source = {*reference->model, source_poses,
                                 reference->frame_time_s};
  const ContactLabels labels = ContactsOf(*reference, source_poses);
  const FlatGround ground;
  measured.source = MeasureMotion(source, labels);
  measured.quality = MeasureMotion(motion, labels, &ground);
  measured.comparison =
      CompareMotion(source, *measured.source, motion, measured.quality);
  return measured;
}

absl::StatusOr<Eigen::MatrixXd> RetargetBody(
    const MovingBody& source, std::shared_ptr<const BodyModel> target,
    LookAhead look_ahead, const RetargetOptions& options) {
  if (!source.has_motion()) {
    return absl::InvalidArgumentError("no motion to retarget");
  }
  if (look_ahead == LookAhead::kNone) {
    return RetargetFrames(source, std::move(target), options);
  }
  absl::StatusOr<RetargetedClip> clip =
      RetargetClip(source.model, std::move(target), source.positions,
                   source.frame_time_s, options);
  if (!clip.ok()) return clip.status();
  return std::move(clip->positions);
}

}  // namespace gelenk
