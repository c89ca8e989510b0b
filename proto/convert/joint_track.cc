#include "convert/joint_track.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk::convert {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;

absl::Status Malformed(absl::string_view field, absl::string_view description) {
  Violations violations;
  violations.Add(field, description);
  return violations.ToStatus();
}

// One column a key.
Eigen::MatrixXd Columns(absl::string_view field, const Numbers& numbers,
                        int rows, size_t keys, Violations& violations) {
  if (static_cast<size_t>(numbers.size()) != rows * keys) {
    violations.Add(field, absl::StrFormat("want %d for each of %d keys, got %d",
                                          rows, keys, numbers.size()));
    return {};
  }
  return Eigen::Map<const Eigen::MatrixXd>(numbers.data(), rows,
                                           static_cast<Eigen::Index>(keys));
}

void AppendColumns(const Eigen::MatrixXd& columns, int first, int count,
                   Numbers* numbers) {
  if (columns.cols() == 0) return;
  const double* begin = columns.data() + columns.rows() * first;
  numbers->Add(begin, begin + columns.rows() * count);
}

// The bits that JointTrack.times_s promises where it is empty.
double FrameTime(int key, double frame_time_s) { return key * frame_time_s; }

bool LieAtFrames(const std::vector<double>& times_s, double frame_time_s) {
  if (!(frame_time_s > 0)) return false;
  for (size_t i = 0; i < times_s.size(); ++i) {
    if (times_s[i] != FrameTime(static_cast<int>(i), frame_time_s)) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::optional<Interpolation> FromProto(v1::Interpolation interpolation) {
  switch (interpolation) {
    case v1::INTERPOLATION_STEP:
      return Interpolation::kStep;
    case v1::INTERPOLATION_LINEAR:
      return Interpolation::kLinear;
    case v1::INTERPOLATION_CUBIC_SPLINE:
      return Interpolation::kCubicSpline;
    case v1::INTERPOLATION_CATMULL_ROM:
      return Interpolation::kCatmullRom;
    default:
      return std::nullopt;
  }
}

v1::Interpolation ToProto(Interpolation interpolation) {
  switch (interpolation) {
    case Interpolation::kStep:
      return v1::INTERPOLATION_STEP;
    case Interpolation::kLinear:
      return v1::INTERPOLATION_LINEAR;
    case Interpolation::kCubicSpline:
      return v1::INTERPOLATION_CUBIC_SPLINE;
    case Interpolation::kCatmullRom:
      return v1::INTERPOLATION_CATMULL_ROM;
  }
  return v1::INTERPOLATION_UNSPECIFIED;
}

absl::StatusOr<int> JointFromProto(absl::string_view field,
                                   const Skeleton& skeleton,
                                   const std::string& joint_id) {
  const int joint = skeleton.FindJoint(joint_id);
  if (joint >= 0) return joint;
  return Malformed(field, absl::StrCat("no joint ", QuotedId(joint_id)));
}

absl::StatusOr<PosePart> FromProto(const Skeleton& skeleton,
                                   const std::string& joint_id,
                                   v1::JointPart part) {
  const absl::StatusOr<int> joint =
      JointFromProto("joint_id", skeleton, joint_id);
  if (!joint.ok()) return joint.status();
  const auto numbers = FindPosePart(skeleton, *joint, PosePartKind::kNumbers);
  const auto rotation = FindPosePart(skeleton, *joint, PosePartKind::kRotation);
  if (part == v1::JOINT_PART_NUMBERS && numbers) return *numbers;
  if (part == v1::JOINT_PART_ROTATION && rotation) return *rotation;
  if (part == v1::JOINT_PART_UNSPECIFIED && !(numbers && rotation)) {
    if (numbers) return *numbers;
    if (rotation) return *rotation;
  }
  return Malformed(
      "part", absl::StrCat(
                  "joint ", QuotedId(joint_id), " has ",
                  numbers ? rotation ? "numbers and a rotation" : "numbers only"
                  : rotation ? "a rotation only"
                             : "nothing that moves by itself",
                  ", got ", static_cast<int>(part)));
}

v1::JointPart ToProto(PosePartKind kind) {
  return kind == PosePartKind::kNumbers ? v1::JOINT_PART_NUMBERS
                                        : v1::JOINT_PART_ROTATION;
}

absl::StatusOr<JointTrack> FromProto(const Skeleton& skeleton,
                                     double frame_time_s,
                                     const v1::JointTrack& proto) {
  const absl::StatusOr<PosePart> part =
      FromProto(skeleton, proto.joint_id(), proto.part());
  if (!part.ok()) return part.status();
  Violations violations;
  JointTrack track;
  track.joint = part->joint;
  track.kind = part->kind;
  const std::optional<Interpolation> interpolation =
      FromProto(proto.interpolation());
  if (!interpolation && proto.interpolation() != 0) {
    violations.Add("interpolation",
                   absl::StrCat("no such interpolation: ",
                                static_cast<int>(proto.interpolation())));
  }
  track.interpolation = interpolation.value_or(Interpolation::kLinear);
  const int rows = part->position_count;
  track.times_s.assign(proto.times_s().begin(), proto.times_s().end());
  if (track.times_s.empty() && frame_time_s > 0) {
    for (int i = 0; i < proto.values_size() / rows; ++i) {
      track.times_s.push_back(FrameTime(i, frame_time_s));
    }
  }
  const size_t keys = track.times_s.size();
  if (keys == 0) violations.Add("times_s", "want at least one, got none");
  track.values = Columns("values", proto.values(), rows, keys, violations);
  const bool has_tangents =
      proto.in_tangents_size() > 0 || proto.out_tangents_size() > 0;
  if (has_tangents || track.interpolation == Interpolation::kCubicSpline) {
    track.in_tangents =
        Columns("in_tangents", proto.in_tangents(), rows, keys, violations);
    track.out_tangents =
        Columns("out_tangents", proto.out_tangents(), rows, keys, violations);
  }
  if (!violations.empty()) return violations.ToStatus();
  return track;
}

absl::StatusOr<std::vector<JointTrack>> FromProto(
    const Skeleton& skeleton, double frame_time_s,
    const google::protobuf::RepeatedPtrField<v1::JointTrack>& protos) {
  Violations violations;
  std::vector<JointTrack> tracks;
  tracks.reserve(protos.size());
  for (int i = 0; i < protos.size(); ++i) {
    absl::StatusOr<JointTrack> track =
        FromProto(skeleton, frame_time_s, protos[i]);
    violations.AddStatus(absl::StrCat("tracks[", i, "]"), track.status());
    if (track.ok()) tracks.push_back(*std::move(track));
  }
  if (!violations.empty()) return violations.ToStatus();
  return tracks;
}

void ToProto(const Skeleton& skeleton, double frame_time_s,
             const JointTrack& track, int first, int count,
             v1::JointTrack* proto) {
  proto->Clear();
  proto->set_joint_id(skeleton.joint(track.joint).id);
  proto->set_part(ToProto(track.kind));
  proto->set_interpolation(ToProto(track.interpolation));
  if (!LieAtFrames(track.times_s, frame_time_s)) {
    const double* begin = track.times_s.data() + first;
    proto->mutable_times_s()->Add(begin, begin + count);
  }
  AppendColumns(track.values, first, count, proto->mutable_values());
  AppendColumns(track.in_tangents, first, count, proto->mutable_in_tangents());
  AppendColumns(track.out_tangents, first, count,
                proto->mutable_out_tangents());
}

}  // namespace gelenk::convert
