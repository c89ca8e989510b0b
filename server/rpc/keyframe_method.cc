#include "server/rpc/keyframe_method.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "convert/joint_track.h"
#include "convert/pose.h"
#include "gelenk/base/violations.h"
#include "gelenk/motion/keyframe_edit.h"
#include "server/rpc/clip_message.h"
#include "server/rpc/find_session.h"

namespace gelenk::server {
namespace {

// Each makes a clip of its own on the way.
constexpr int kMaxEdits = 128;

// INVALID_ARGUMENT for numbers that name none.
absl::StatusOr<Interpolation> NewTrackInterpolation(
    v1::Interpolation interpolation) {
  if (interpolation == v1::INTERPOLATION_UNSPECIFIED) {
    return Interpolation::kCatmullRom;
  }
  const auto known = convert::FromProto(interpolation);
  if (known) return *known;
  Violations violations;
  violations.Add(
      "interpolation",
      absl::StrCat("no such interpolation: ", static_cast<int>(interpolation)));
  return violations.ToStatus();
}

absl::StatusOr<MotionClip> Apply(const MotionClip& clip,
                                 const v1::InsertKey& edit) {
  const auto part =
      convert::FromProto(*clip.skeleton(), edit.joint_id(), edit.part());
  if (!part.ok()) return part.status();
  const auto interpolation = NewTrackInterpolation(edit.interpolation());
  if (!interpolation.ok()) return interpolation.status();
  return InsertKey(clip, part->joint, part->kind, edit.time_s(), edit.values(),
                   edit.keep_children_in_world() ? ChildrenOnEdit::kKeepWorld
                                                 : ChildrenOnEdit::kFollow,
                   *interpolation);
}

absl::StatusOr<MotionClip> Apply(const MotionClip& clip,
                                 const v1::MoveKey& edit) {
  const auto part =
      convert::FromProto(*clip.skeleton(), edit.joint_id(), edit.part());
  if (!part.ok()) return part.status();
  return MoveKey(clip, part->joint, part->kind, edit.from_s(), edit.to_s());
}

absl::StatusOr<MotionClip> Apply(const MotionClip& clip,
                                 const v1::DeleteKey& edit) {
  const auto part =
      convert::FromProto(*clip.skeleton(), edit.joint_id(), edit.part());
  if (!part.ok()) return part.status();
  return DeleteKey(clip, part->joint, part->kind, edit.time_s());
}

absl::StatusOr<Eigen::VectorXd> SessionPose(const ServiceState& state,
                                            const std::string& name,
                                            const Skeleton* skeleton) {
  const auto session = FindSession(state, "session", name);
  if (!session.ok()) return session.status();
  if (&(*session)->skeleton() != skeleton) {
    return absl::FailedPreconditionError(
        absl::StrCat("session: ", name, " is of ", (*session)->skeleton_name(),
                     ", another skeleton than the clip's"));
  }
  Eigen::VectorXd positions;
  (*session)->CopyPositions(positions);
  return positions;
}

absl::StatusOr<MotionClip> Apply(const ServiceState& state,
                                 const MotionClip& clip,
                                 const v1::CapturePose& edit) {
  const Skeleton& skeleton = *clip.skeleton();
  Violations violations;
  absl::StatusOr<Eigen::VectorXd> positions = Eigen::VectorXd();
  if (edit.has_session()) {
    positions = SessionPose(state, edit.session(), &skeleton);
    if (!positions.ok()) return positions.status();
  } else if (edit.has_pose()) {
    positions = convert::FromProto(skeleton, edit.pose());
    violations.AddStatus("pose", positions.status());
  } else {
    violations.Add("source", "want a session or a pose, got neither");
  }
  const auto interpolation = NewTrackInterpolation(edit.interpolation());
  violations.AddStatus("", interpolation.status());
  std::vector<int> joints;
  for (int i = 0; i < edit.joint_ids_size(); ++i) {
    const absl::StatusOr<int> joint = convert::JointFromProto(
        absl::StrCat("joint_ids[", i, "]"), skeleton, edit.joint_ids(i));
    violations.AddStatus("", joint.status());
    if (joint.ok()) joints.push_back(*joint);
  }
  if (!violations.empty()) return violations.ToStatus();
  return CapturePose(clip, edit.time_s(), *positions, joints, *interpolation);
}

absl::StatusOr<MotionClip> Apply(const ServiceState& state,
                                 const MotionClip& clip,
                                 const v1::KeyframeEdit& edit) {
  switch (edit.edit_case()) {
    case v1::KeyframeEdit::kInsertKey:
      return Apply(clip, edit.insert_key());
    case v1::KeyframeEdit::kMoveKey:
      return Apply(clip, edit.move_key());
    case v1::KeyframeEdit::kDeleteKey:
      return Apply(clip, edit.delete_key());
    case v1::KeyframeEdit::kCapturePose:
      return Apply(state, clip, edit.capture_pose());
    case v1::KeyframeEdit::EDIT_NOT_SET:
      break;
  }
  return absl::InvalidArgumentError("edit: want one, got none");
}

std::string FieldOf(const v1::KeyframeEdit& edit, int index) {
  const std::string field = absl::StrCat("edits[", index, "]");
  switch (edit.edit_case()) {
    case v1::KeyframeEdit::kInsertKey:
      return absl::StrCat(field, ".insert_key");
    case v1::KeyframeEdit::kMoveKey:
      return absl::StrCat(field, ".move_key");
    case v1::KeyframeEdit::kDeleteKey:
      return absl::StrCat(field, ".delete_key");
    case v1::KeyframeEdit::kCapturePose:
      return absl::StrCat(field, ".capture_pose");
    case v1::KeyframeEdit::EDIT_NOT_SET:
      break;
  }
  return field;
}

// All edits, or the first that is none.
absl::StatusOr<MotionClip> ApplyAll(const ServiceState& state, MotionClip clip,
                                    const v1::EditKeyframesRequest& request) {
  for (int i = 0; i < request.edits_size(); ++i) {
    absl::StatusOr<MotionClip> edited = Apply(state, clip, request.edits(i));
    if (absl::IsInvalidArgument(edited.status())) {
      Violations violations;
      violations.AddStatus(FieldOf(request.edits(i), i), edited.status());
      return violations.ToStatus();
    }
    if (!edited.ok()) return edited.status();
    clip = *std::move(edited);
  }
  return clip;
}

absl::Status CheckRequest(const v1::EditKeyframesRequest& request) {
  Violations violations;
  violations.AddStatus("", CheckRequestId(request.request_id()));
  violations.AddStatus(
      "", ParseRevisionName("name", kClips, request.name()).status());
  if (request.edits_size() > kMaxEdits) {
    violations.Add("edits", absl::StrCat("want at most ", kMaxEdits, ", got ",
                                         request.edits_size()));
  }
  return violations.ToStatus();
}

}  // namespace

absl::Status EditKeyframes(ServiceState& state,
                           const v1::EditKeyframesRequest& request,
                           v1::Clip* response) {
  if (absl::Status status = CheckRequest(request); !status.ok()) return status;
  if (AnswerEarlier(state, request.request_id(), response)) {
    return absl::OkStatus();
  }
  while (true) {
    absl::StatusOr<StoredClip> base = FindClip(state, "name", request.name());
    if (!base.ok()) return base.status();
    absl::StatusOr<MotionClip> edited = ApplyAll(state, base->clip, request);
    if (!edited.ok()) return edited.status();
    const int newest = base->newest_revision;
    base->clip = *std::move(edited);
    base->create_time = absl::Now();
    const absl::StatusOr<StoredClip> stored = state.clips.AddRevision(
        kDefaultTenant, request.request_id(), newest, *std::move(base));
    // Somebody else's edit came in between: this one goes on top of it.
    if (absl::IsAborted(stored.status())) continue;
    if (!stored.ok()) return stored.status();
    ToProto(*stored, response);
    return absl::OkStatus();
  }
}

}  // namespace gelenk::server
