#include "gelenk/motion/motion_clip.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {
namespace {

void CheckTime(absl::string_view field, double time_s, Violations& violations) {
  if (std::isfinite(time_s) && time_s >= 0) return;
  violations.Add(field,
                 absl::StrCat("want a finite number >= 0, got ", time_s));
}

void CheckProperties(const Skeleton& skeleton, ClipProperties& properties,
                     Violations& violations) {
  CheckTime("frame_time_s", properties.frame_time_s, violations);
  if (properties.seam_s) CheckTime("seam_s", *properties.seam_s, violations);
  if (properties.base_positions.size() == 0) {
    properties.base_positions = skeleton.rest_positions();
  }
  violations.AddStatus("base_positions",
                       CheckPositions(skeleton, properties.base_positions));
}

void CheckNoTwoAlike(const Skeleton& skeleton,
                     const std::vector<JointTrack>& tracks,
                     Violations& violations) {
  // First track of each number of q.
  std::vector<int> taken(skeleton.position_count(), -1);
  for (size_t i = 0; i < tracks.size(); ++i) {
    const std::optional<PosePart> part =
        FindPosePart(skeleton, tracks[i].joint, tracks[i].kind);
    int& first = taken[part->position_offset];
    if (first >= 0) {
      violations.Add(
          absl::StrCat("tracks[", i, "].joint"),
          absl::StrFormat("the %s of joint %s are those of tracks[%d] already",
                          PosePartKindName(tracks[i].kind),
                          QuotedId(skeleton.joint(tracks[i].joint).id), first));
    } else {
      first = static_cast<int>(i);
    }
  }
}

}  // namespace

absl::StatusOr<MotionClip> MotionClip::Create(
    std::shared_ptr<const Skeleton> skeleton, std::vector<JointTrack> tracks,
    ClipProperties properties) {
  Violations violations;
  CheckProperties(*skeleton, properties, violations);
  for (size_t i = 0; i < tracks.size(); ++i) {
    CheckAndNormalize(absl::StrCat("tracks[", i, "]"), *skeleton, tracks[i],
                      violations);
  }
  if (violations.empty()) CheckNoTwoAlike(*skeleton, tracks, violations);
  if (!violations.empty()) return violations.ToStatus();

  MotionClip clip;
  for (const JointTrack& track : tracks) {
    clip.duration_s_ = std::max(clip.duration_s_, track.times_s.back());
  }
  clip.curves_.reserve(tracks.size());
  for (JointTrack& track : tracks) {
    const PosePart part = *FindPosePart(*skeleton, track.joint, track.kind);
    clip.curves_.push_back(std::make_shared<const TrackCurve>(
        std::move(track), part, clip.duration_s_, properties.seam_s));
  }
  clip.skeleton_ = std::move(skeleton);
  clip.properties_ = std::move(properties);
  return clip;
}

int MotionClip::FindTrack(int joint, PosePartKind kind) const {
  for (int i = 0; i < track_count(); ++i) {
    if (track(i).joint == joint && track(i).kind == kind) return i;
  }
  return -1;
}

std::vector<JointTrack> MotionClip::CopyTracks() const {
  std::vector<JointTrack> tracks;
  tracks.reserve(curves_.size());
  for (const auto& curve : curves_) tracks.push_back(curve->track());
  return tracks;
}

size_t MotionClip::ByteSize() const {
  size_t bytes = sizeof(MotionClip);
  for (const auto& curve : curves_) {
    const JointTrack& track = curve->track();
    const size_t numbers = track.times_s.size() + track.values.size() +
                           track.in_tangents.size() +
                           track.out_tangents.size() +
                           (track.interpolation == Interpolation::kCatmullRom
                                ? 3 * track.times_s.size()
                                : 0);
    bytes += sizeof(TrackCurve) + numbers * sizeof(double);
  }
  return bytes;
}

}  // namespace gelenk
