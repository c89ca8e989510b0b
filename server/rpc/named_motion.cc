#include "server/rpc/named_motion.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "convert/joint_map.h"
#include "gelenk/base/violations.h"
#include "gelenk/motion/clip_frames.h"
#include "server/rpc/clip_message.h"
#include "server/rpc/find_skeleton.h"

namespace gelenk::server {

absl::StatusOr<NamedMotion> MotionOf(const ServiceState& state,
                                     absl::string_view field,
                                     const StoredClip& stored) {
  if (absl::Status status =
          CheckFrameCount(field, stored.clip, state.options.limits);
      !status.ok()) {
    return status;
  }
  NamedMotion motion{stored.skeleton_name, stored.clip.skeleton()};
  motion.frame_time_s = FrameTimeOf(stored.clip);
  absl::StatusOr<Eigen::MatrixXd> frames =
      FramesFromClip(stored.clip, motion.frame_time_s);
  if (!frames.ok()) return frames.status();
  motion.frames = *std::move(frames);
  motion.form = stored.form;
  motion.unit_m = stored.unit_m;
  return motion;
}

absl::StatusOr<NamedMotion> MotionOf(const ServiceState& state,
                                     absl::string_view field,
                                     const std::string& clip) {
  const absl::StatusOr<StoredClip> stored = FindClip(state, field, clip);
  if (!stored.ok()) return stored.status();
  return MotionOf(state, field, *stored);
}

absl::StatusOr<NamedMotion> MotionOf(const ServiceState& state,
                                     absl::string_view field,
                                     const v1::BodySource& source) {
  switch (source.source_case()) {
    case v1::BodySource::kSkeleton: {
      const absl::StatusOr<StoredSkeleton> stored = FindSkeleton(
          state, absl::StrCat(field, ".skeleton"), source.skeleton());
      if (!stored.ok()) return stored.status();
      return NamedMotion{stored->name, stored->skeleton};
    }
    case v1::BodySource::kClip:
      return MotionOf(state, absl::StrCat(field, ".clip"), source.clip());
    case v1::BodySource::SOURCE_NOT_SET:
      break;
  }
  Violations violations;
  violations.Add(field, "want a skeleton or a clip, got neither");
  return violations.ToStatus();
}

absl::StatusOr<MovingBody> BodyOf(absl::string_view field, NamedMotion motion,
                                  const Overrides& overrides) {
  absl::StatusOr<MovingBody> body =
      MakeMovingBody(motion.skeleton, std::move(motion.frames),
                     motion.frame_time_s, overrides);
  if (body.ok()) return body;
  return absl::FailedPreconditionError(
      absl::StrCat(field, ": ", motion.skeleton_name,
                   " is no body to read: ", body.status().message()));
}

absl::StatusOr<BothOverrides> OverridesOf(absl::string_view field,
                                          const v1::JointMap& map,
                                          const Skeleton& source,
                                          const Skeleton& target) {
  Violations violations;
  absl::StatusOr<Overrides> of_source =
      convert::FromProto(map, convert::MapSide::kSource, source);
  absl::StatusOr<Overrides> of_target =
      convert::FromProto(map, convert::MapSide::kTarget, target);
  violations.AddStatus(field, of_source.status());
  // Roles are wrong for both sides alike.
  if (of_source.ok()) violations.AddStatus(field, of_target.status());
  if (!violations.empty()) return violations.ToStatus();
  return BothOverrides{*std::move(of_source), *std::move(of_target)};
}

}  // namespace gelenk::server
