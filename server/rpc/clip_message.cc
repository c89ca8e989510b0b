#include "server/rpc/clip_message.h"

#include <optional>

#include "absl/strings/str_format.h"
#include "convert/pose.h"
#include "gelenk/base/violations.h"
#include "gelenk/motion/clip_frames.h"
#include "server/rpc/session_message.h"

namespace gelenk::server {

void ToProto(const StoredClip& stored, v1::Clip* proto) {
  const MotionClip& clip = stored.clip;
  const ClipProperties& properties = clip.properties();
  proto->set_name(stored.name);
  proto->set_revision(stored.revision);
  proto->set_oldest_revision(stored.oldest_revision);
  proto->set_newest_revision(stored.newest_revision);
  proto->set_display_name(stored.display_name);
  proto->set_skeleton(stored.skeleton_name);
  proto->set_frame_time_s(properties.frame_time_s);
  if (properties.seam_s) proto->set_seam_s(*properties.seam_s);
  convert::ToProto(properties.base_positions, proto->mutable_base_pose());
  proto->set_duration_s(clip.duration_s());
  int64_t keys = 0;
  for (int i = 0; i < clip.track_count(); ++i) {
    keys += clip.track(i).key_count();
  }
  proto->set_key_count(keys);
  proto->set_track_count(clip.track_count());
  proto->set_byte_size(static_cast<int64_t>(stored.ByteSize()));
  proto->set_unit_m(stored.unit_m);
  for (const std::string& warning : stored.warnings) {
    proto->add_warnings(warning);
  }
  ToProto(stored.create_time, proto->mutable_create_time());
}

absl::StatusOr<StoredClip> FindClip(const ServiceState& state,
                                    absl::string_view field,
                                    absl::string_view name) {
  const absl::StatusOr<RevisionedName> parsed =
      ParseRevisionName(field, kClips, name);
  if (!parsed.ok()) return parsed.status();
  return state.clips.Find(kDefaultTenant, *parsed);
}

absl::Status CheckFrameCount(absl::string_view field, double frames,
                             const Skeleton& skeleton, const Limits& limits) {
  const double most = static_cast<double>(limits.max_clip_numbers);
  // NaN is for others to refuse.
  if (!(frames * skeleton.position_count() > most)) return absl::OkStatus();
  Violations violations;
  violations.Add(field, absl::StrFormat("%.0f frames of %d numbers are more "
                                        "than the %d that a clip may have",
                                        frames, skeleton.position_count(),
                                        limits.max_clip_numbers));
  return violations.ToStatus();
}

absl::Status CheckFrameCount(absl::string_view field, const MotionClip& clip,
                             const Limits& limits) {
  return CheckFrameCount(field, clip.duration_s() / FrameTimeOf(clip) + 1,
                         *clip.skeleton(), limits);
}

bool AnswerEarlier(const ServiceState& state, absl::string_view request_id,
                   v1::Clip* response) {
  const std::optional<StoredClip> earlier =
      state.clips.FindRequest(kDefaultTenant, request_id);
  if (earlier) ToProto(*earlier, response);
  return earlier.has_value();
}

absl::Status CheckNewClip(absl::string_view id_field, const std::string& id,
                          const std::string& request_id) {
  Violations violations;
  if (!id.empty()) violations.AddStatus("", CheckResourceId(id_field, id));
  violations.AddStatus("", CheckRequestId(request_id));
  return violations.ToStatus();
}

}  // namespace gelenk::server
