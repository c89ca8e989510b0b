// Keyframe tracks between the contract and the core.
#ifndef GELENK_CONVERT_JOINT_TRACK_H_
#define GELENK_CONVERT_JOINT_TRACK_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/motion/joint_track.h"
#include "gelenk/motion/pose_part.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/v1/motion.pb.h"

namespace gelenk::convert {

// None for INTERPOLATION_UNSPECIFIED and numbers that name none.
std::optional<Interpolation> FromProto(v1::Interpolation interpolation);
v1::Interpolation ToProto(Interpolation interpolation);

// INVALID_ARGUMENT naming `field` for a joint that is not there.
absl::StatusOr<int> JointFromProto(absl::string_view field,
                                   const Skeleton& skeleton,
                                   const std::string& joint_id);

// INVALID_ARGUMENT naming "joint_id" or "part" for a joint that is not there or
// has no such numbers, or both kinds while `part` does not say which.
absl::StatusOr<PosePart> FromProto(const Skeleton& skeleton,
                                   const std::string& joint_id,
                                   v1::JointPart part);
v1::JointPart ToProto(PosePartKind kind);

// INVALID_ARGUMENT for what the core's type cannot hold (see above, and numbers
// that are not as many as the times); MotionClip::Create checks the rest.
// `frame_time_s` tells times that are left out.
absl::StatusOr<JointTrack> FromProto(const Skeleton& skeleton,
                                     double frame_time_s,
                                     const v1::JointTrack& proto);

// All of `protos`, errors as "tracks[3].joint_id".
absl::StatusOr<std::vector<JointTrack>> FromProto(
    const Skeleton& skeleton, double frame_time_s,
    const google::protobuf::RepeatedPtrField<v1::JointTrack>& protos);

// `count` keys of a track from `first` on. Times that follow from
// `frame_time_s` are left out.
void ToProto(const Skeleton& skeleton, double frame_time_s,
             const JointTrack& track, int first, int count,
             v1::JointTrack* proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_JOINT_TRACK_H_
