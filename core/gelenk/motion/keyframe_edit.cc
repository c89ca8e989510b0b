#include "gelenk/motion/keyframe_edit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/sampler.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

absl::Status CheckTime(const char* field, double time_s) {
  if (std::isfinite(time_s) && time_s >= 0) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(field, ": want a finite number >= 0, got ", time_s));
}

absl::Status CheckJoint(const Skeleton& skeleton, int joint,
                        PosePartKind kind) {
  if (joint < 0 || joint >= skeleton.joint_count()) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "joint: want 0 to %d, got %d", skeleton.joint_count() - 1, joint));
  }
  if (!FindPosePart(skeleton, joint, kind)) {
    return absl::InvalidArgumentError(
        absl::StrCat("kind: joint ", QuotedId(skeleton.joint(joint).id),
                     " has no ", PosePartKindName(kind)));
  }
  return absl::OkStatus();
}

// Of the key at `time_s`, -1 for none.
int FindKey(const JointTrack& track, double time_s) {
  for (int i = 0; i < track.key_count(); ++i) {
    if (std::abs(track.times_s[i] - time_s) <= kSameKey_s) return i;
  }
  return -1;
}

void InsertColumn(Eigen::MatrixXd& matrix, Eigen::Index at,
                  const Eigen::VectorXd& column) {
  Eigen::MatrixXd wider(column.size(), matrix.cols() + 1);
  wider.leftCols(at) = matrix.leftCols(at);
  wider.col(at) = column;
  wider.rightCols(matrix.cols() - at) = matrix.rightCols(matrix.cols() - at);
  matrix = std::move(wider);
}

void EraseColumn(Eigen::MatrixXd& matrix, Eigen::Index at) {
  Eigen::MatrixXd narrower(matrix.rows(), matrix.cols() - 1);
  narrower.leftCols(at) = matrix.leftCols(at);
  narrower.rightCols(narrower.cols() - at) =
      matrix.rightCols(narrower.cols() - at);
  matrix = std::move(narrower);
}

// Change per second around key `at` of its neighbours.
Eigen::VectorXd ChordTangent(const JointTrack& track, int at) {
  const int before = std::max(at - 1, 0);
  const int after = std::min(at + 1, track.key_count() - 1);
  if (before == after) return Eigen::VectorXd::Zero(track.values.rows());
  return (track.values.col(after) - track.values.col(before)) /
         (track.times_s[after] - track.times_s[before]);
}

void SetKey(JointTrack& track, double time_s, const Eigen::VectorXd& values) {
  const int same = FindKey(track, time_s);
  if (same >= 0) {
    // A cubic's tangents hang on the quaternion's sign.
    const bool is_opposite = track.kind == PosePartKind::kRotation &&
                             track.values.col(same).dot(values) < 0;
    track.values.col(same) = is_opposite ? Eigen::VectorXd(-values) : values;
    return;
  }
  const auto after =
      std::upper_bound(track.times_s.begin(), track.times_s.end(), time_s);
  const int at = static_cast<int>(after - track.times_s.begin());
  track.times_s.insert(after, time_s);
  Eigen::VectorXd column = values;
  if (track.kind == PosePartKind::kRotation && track.values.cols() > 0 &&
      track.values.col(std::max(at - 1, 0)).dot(values) < 0) {
    column = -column;
  }
  InsertColumn(track.values, at, column);
  if (track.interpolation != Interpolation::kCubicSpline) return;
  const Eigen::VectorXd tangent = ChordTangent(track, at);
  InsertColumn(track.in_tangents, at, tangent);
  InsertColumn(track.out_tangents, at, tangent);
}

// A track of `joint` in `tracks`, made where there is none.
JointTrack& TrackOf(std::vector<JointTrack>& tracks, int joint,
                    PosePartKind kind, int rows, Interpolation interpolation) {
  for (JointTrack& track : tracks) {
    if (track.joint == joint && track.kind == kind) return track;
  }
  if (interpolation == Interpolation::kCubicSpline) {
    // It has no tangents yet.
    interpolation = Interpolation::kCatmullRom;
  }
  JointTrack& track = tracks.emplace_back();
  track.joint = joint;
  track.kind = kind;
  track.interpolation = interpolation;
  track.values.resize(rows, 0);
  return track;
}

absl::StatusOr<MotionClip> Revised(const MotionClip& clip,
                                   std::vector<JointTrack> tracks) {
  return MotionClip::Create(clip.skeleton(), std::move(tracks),
                            clip.properties());
}

Eigen::VectorXd PoseAt(const MotionClip& clip, double time_s) {
  Eigen::VectorXd positions = clip.properties().base_positions;
  Sampler(clip).Sample(time_s, positions);
  return positions;
}

void SetPart(const Skeleton& skeleton, int joint, PosePartKind kind,
             const Eigen::VectorXd& positions, double time_s,
             Interpolation interpolation, std::vector<JointTrack>& tracks) {
  const std::optional<PosePart> part = FindPosePart(skeleton, joint, kind);
  if (!part) return;
  SetKey(TrackOf(tracks, joint, kind, part->position_count, interpolation),
         time_s,
         positions.segment(part->position_offset, part->position_count));
}

// Keys for the children of `joint` by which they stand in the world at `after`
// as they did at `before`.
void CounterChildren(const Skeleton& skeleton, int joint,
                     const Eigen::VectorXd& before, Eigen::VectorXd after,
                     double time_s, Interpolation interpolation,
                     std::vector<JointTrack>& tracks) {
  WorldTransforms old_frames, frames;
  ForwardKinematics(skeleton, before, old_frames);
  ForwardKinematics(skeleton, after, frames);
  for (int child = joint + 1; child < skeleton.joint_count(); ++child) {
    const int at = skeleton.span(child).quaternion_offset;
    if (skeleton.span(child).parent != joint || at < 0) continue;
    const RigidTransform local =
        (frames[joint] * skeleton.joint(child).parent_from_joint).Inverse() *
        old_frames[child];
    StoreXyzw(local.rotation.normalized(), after.data() + at);
    SetPart(skeleton, child, PosePartKind::kRotation, after, time_s,
            interpolation, tracks);
    if (skeleton.joint(child).type != JointType::kFree) continue;
    after.segment<3>(at - 3) = local.translation;
    SetPart(skeleton, child, PosePartKind::kNumbers, after, time_s,
            interpolation, tracks);
  }
}

}  // namespace

absl::StatusOr<MotionClip> InsertKey(const MotionClip& clip, int joint,
                                     PosePartKind kind, double time_s,
                                     absl::Span<const double> values,
                                     ChildrenOnEdit children,
                                     Interpolation interpolation) {
  const Skeleton& skeleton = *clip.skeleton();
  if (absl::Status status = CheckJoint(skeleton, joint, kind); !status.ok()) {
    return status;
  }
  if (absl::Status status = CheckTime("time_s", time_s); !status.ok()) {
    return status;
  }
  const PosePart part = *FindPosePart(skeleton, joint, kind);
  if (values.size() != static_cast<size_t>(part.position_count)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "values: want %d numbers, got %d", part.position_count, values.size()));
  }
  const Eigen::VectorXd before = PoseAt(clip, time_s);
  Eigen::VectorXd after = before;
  std::copy(values.begin(), values.end(), after.data() + part.position_offset);
  if (absl::Status status = CheckPositions(skeleton, after); !status.ok()) {
    return status;
  }
  std::vector<JointTrack> tracks = clip.CopyTracks();
  SetPart(skeleton, joint, kind, after, time_s, interpolation, tracks);
  if (children == ChildrenOnEdit::kKeepWorld) {
    CounterChildren(skeleton, joint, before, std::move(after), time_s,
                    interpolation, tracks);
  }
  return Revised(clip, std::move(tracks));
}

absl::StatusOr<MotionClip> MoveKey(const MotionClip& clip, int joint,
                                   PosePartKind kind, double from_s,
                                   double to_s) {
  if (absl::Status status = CheckTime("to_s", to_s); !status.ok()) {
    return status;
  }
  const int index = clip.FindTrack(joint, kind);
  const int key = index < 0 ? -1 : FindKey(clip.track(index), from_s);
  if (key < 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("from_s: no key at %g s", from_s));
  }
  std::vector<JointTrack> tracks = clip.CopyTracks();
  JointTrack& track = tracks[index];
  const int there = FindKey(track, to_s);
  if (there >= 0 && there != key) {
    return absl::InvalidArgumentError(
        absl::StrFormat("to_s: there is a key at %g s already", to_s));
  }
  // Out and in again: it may have moved past others.
  const bool is_cubic = track.interpolation == Interpolation::kCubicSpline;
  const Eigen::VectorXd value = track.values.col(key);
  const Eigen::VectorXd in =
      is_cubic ? track.in_tangents.col(key) : Eigen::VectorXd();
  const Eigen::VectorXd out =
      is_cubic ? track.out_tangents.col(key) : Eigen::VectorXd();
  track.times_s.erase(track.times_s.begin() + key);
  EraseColumn(track.values, key);
  const auto after =
      std::upper_bound(track.times_s.begin(), track.times_s.end(), to_s);
  const Eigen::Index at = after - track.times_s.begin();
  track.times_s.insert(after, to_s);
  InsertColumn(track.values, at, value);
  if (is_cubic) {
    EraseColumn(track.in_tangents, key);
    EraseColumn(track.out_tangents, key);
    InsertColumn(track.in_tangents, at, in);
    InsertColumn(track.out_tangents, at, out);
  }
  return Revised(clip, std::move(tracks));
}

absl::StatusOr<MotionClip> DeleteKey(const MotionClip& clip, int joint,
                                     PosePartKind kind, double time_s) {
  const int index = clip.FindTrack(joint, kind);
  const int key = index < 0 ? -1 : FindKey(clip.track(index), time_s);
  if (key < 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("time_s: no key at %g s", time_s));
  }
  std::vector<JointTrack> tracks = clip.CopyTracks();
  JointTrack& track = tracks[index];
  if (track.key_count() == 1) {
    tracks.erase(tracks.begin() + index);
    return Revised(clip, std::move(tracks));
  }
  track.times_s.erase(track.times_s.begin() + key);
  EraseColumn(track.values, key);
  if (track.interpolation == Interpolation::kCubicSpline) {
    EraseColumn(track.in_tangents, key);
    EraseColumn(track.out_tangents, key);
  }
  return Revised(clip, std::move(tracks));
}

absl::StatusOr<MotionClip> CapturePose(const MotionClip& clip, double time_s,
                                       const ConstVectorView& positions,
                                       absl::Span<const int> joints,
                                       Interpolation interpolation) {
  const Skeleton& skeleton = *clip.skeleton();
  if (absl::Status status = CheckTime("time_s", time_s); !status.ok()) {
    return status;
  }
  Eigen::VectorXd checked = positions;
  if (absl::Status status = CheckPositions(skeleton, checked); !status.ok()) {
    return status;
  }
  std::vector<bool> is_chosen(skeleton.joint_count(), joints.empty());
  for (int joint : joints) {
    if (joint < 0 || joint >= skeleton.joint_count()) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "joints: want 0 to %d, got %d", skeleton.joint_count() - 1, joint));
    }
    is_chosen[joint] = true;
  }
  std::vector<JointTrack> tracks = clip.CopyTracks();
  for (const PosePart& part : PosePartsOf(skeleton)) {
    if (!is_chosen[part.joint]) continue;
    SetPart(skeleton, part.joint, part.kind, checked, time_s, interpolation,
            tracks);
  }
  return Revised(clip, std::move(tracks));
}

RevisionHistory::RevisionHistory(MotionClip clip, int max_revisions)
    : max_revisions_(std::max(max_revisions, 1)) {
  revisions_.push_back({last_number_, std::move(clip)});
}

int RevisionHistory::Commit(MotionClip clip) {
  revisions_.resize(place_ + 1, revisions_[place_]);
  if (revisions_.size() == max_revisions_) {
    revisions_.erase(revisions_.begin());
  }
  revisions_.push_back({++last_number_, std::move(clip)});
  place_ = revisions_.size() - 1;
  return last_number_;
}

bool RevisionHistory::Undo() {
  if (place_ == 0) return false;
  --place_;
  return true;
}

bool RevisionHistory::Redo() {
  if (place_ + 1 == revisions_.size()) return false;
  ++place_;
  return true;
}

absl::StatusOr<MotionClip> RevisionHistory::At(int revision) const {
  for (const Revision& kept : revisions_) {
    if (kept.number == revision) return kept.clip;
  }
  return absl::NotFoundError(absl::StrFormat(
      "revision: there is no %d, those kept are %d to %d", revision,
      revisions_.front().number, revisions_.back().number));
}

}  // namespace gelenk
