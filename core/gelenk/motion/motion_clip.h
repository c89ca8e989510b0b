// Motion over time: q(t) of one skeleton, as keyframe tracks of its joints.
//
// A value: immutable, cheap to copy (tracks are shared), safe to read from any
// thread. Times are seconds from the clip's start, in double as the source has
// them; the clip ends at its last key. What has no track stays at
// `base_positions`.
#ifndef GELENK_MOTION_MOTION_CLIP_H_
#define GELENK_MOTION_MOTION_CLIP_H_

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/motion/joint_track.h"
#include "gelenk/motion/track_curve.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct ClipProperties {
  std::string name = {};
  // Of a clip that was sampled evenly, exactly as its source says; 0 for one
  // that was not.
  double frame_time_s = 0;
  // Set for a cycle: in a loop the first key follows the last one after this
  // time, >= 0. At 0 the last key is the first one again; a cycle of frames
  // whose last is not the first again has its frame time here.
  std::optional<double> seam_s = std::nullopt;
  // What joints without track do; empty means the rest pose.
  Eigen::VectorXd base_positions = {};
};

class MotionClip {
 public:
  // Tracks in any order, at most one per joint and kind. INVALID_ARGUMENT
  // listing every malformed field ("tracks[2].times_s[7]: ..."): numbers that
  // are not finite, times that do not grow, wrong sizes, quaternions that are
  // not near unit, two tracks for the same numbers. Cost: linear.
  static absl::StatusOr<MotionClip> Create(
      std::shared_ptr<const Skeleton> skeleton, std::vector<JointTrack> tracks,
      ClipProperties properties = {});

  const std::shared_ptr<const Skeleton>& skeleton() const { return skeleton_; }
  const ClipProperties& properties() const { return properties_; }
  const std::string& name() const { return properties_.name; }

  // Of the last key; 0 without tracks.
  double duration_s() const { return duration_s_; }
  // Of one round of a loop: the duration and the seam.
  double period_s() const {
    return duration_s_ + properties_.seam_s.value_or(0);
  }

  int track_count() const { return static_cast<int>(curves_.size()); }
  const JointTrack& track(int index) const { return curves_[index]->track(); }
  const TrackCurve& curve(int index) const { return *curves_[index]; }
  // Index of a track, -1 for none. Cost: linear in the tracks.
  int FindTrack(int joint, PosePartKind kind) const;
  // A copy of all tracks, to change and Create from.
  std::vector<JointTrack> CopyTracks() const;

  // Bytes that the keys hold, for quotas; copies share them.
  size_t ByteSize() const;

 private:
  MotionClip() = default;

  std::shared_ptr<const Skeleton> skeleton_;
  ClipProperties properties_;
  double duration_s_ = 0;
  std::vector<std::shared_ptr<const TrackCurve>> curves_;
};

}  // namespace gelenk

#endif  // GELENK_MOTION_MOTION_CLIP_H_
