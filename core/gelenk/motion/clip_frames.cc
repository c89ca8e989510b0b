#include "gelenk/motion/clip_frames.h"

#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/motion/sampler.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {
namespace {

// Part of a frame that rounding may take from a duration.
constexpr double kFrameSlack = 1e-3;

absl::Status CheckFrames(const Skeleton& skeleton, Eigen::MatrixXd& frames,
                         double frame_time_s) {
  Violations violations;
  if (!(std::isfinite(frame_time_s) && frame_time_s > 0)) {
    violations.Add(
        "frame_time_s",
        absl::StrCat("want a finite number > 0, got ", frame_time_s));
  }
  if (frames.rows() != skeleton.position_count() || frames.cols() < 1 ||
      frames.cols() > kMaxClipFrames) {
    violations.Add(
        "frames",
        absl::StrFormat("want 1 to %d frames of %d numbers, got %d of %d",
                        kMaxClipFrames, skeleton.position_count(),
                        frames.cols(), frames.rows()));
    return violations.ToStatus();
  }
  for (Eigen::Index i = 0; i < frames.cols(); ++i) {
    const absl::Status status = CheckPositions(skeleton, frames.col(i));
    if (!status.ok())
      violations.AddStatus(absl::StrCat("frames[", i, "]"), status);
  }
  return violations.ToStatus();
}

}  // namespace

absl::StatusOr<MotionClip> ClipFromFrames(
    std::shared_ptr<const Skeleton> skeleton, const Eigen::MatrixXd& frames,
    ClipProperties properties, Interpolation interpolation) {
  if (interpolation == Interpolation::kCubicSpline) {
    return absl::InvalidArgumentError(
        "interpolation: frames have no tangents for a cubic spline");
  }
  Eigen::MatrixXd checked = frames;
  const absl::Status status =
      CheckFrames(*skeleton, checked, properties.frame_time_s);
  if (!status.ok()) return status;
  std::vector<double> times_s(checked.cols());
  for (size_t i = 0; i < times_s.size(); ++i) {
    times_s[i] = static_cast<double>(i) * properties.frame_time_s;
  }
  std::vector<JointTrack> tracks;
  for (const PosePart& part : PosePartsOf(*skeleton)) {
    tracks.push_back({.joint = part.joint,
                      .kind = part.kind,
                      .interpolation = interpolation,
                      .times_s = times_s,
                      .values = checked.middleRows(part.position_offset,
                                                   part.position_count)});
  }
  return MotionClip::Create(std::move(skeleton), std::move(tracks),
                            std::move(properties));
}

absl::StatusOr<Eigen::MatrixXd> FramesFromClip(const MotionClip& clip,
                                               double frame_time_s) {
  if (!(std::isfinite(frame_time_s) && frame_time_s > 0)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "frame_time_s: want a finite number > 0, got ", frame_time_s));
  }
  const double steps =
      std::floor(clip.duration_s() / frame_time_s + kFrameSlack);
  if (!(steps < kMaxClipFrames)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "frame_time_s: want at most %d frames in %g s, got %g s a frame",
        kMaxClipFrames, clip.duration_s(), frame_time_s));
  }
  const Skeleton& skeleton = *clip.skeleton();
  Eigen::MatrixXd frames(skeleton.position_count(),
                         static_cast<Eigen::Index>(steps) + 1);
  Sampler sampler(clip);
  for (Eigen::Index i = 0; i < frames.cols(); ++i) {
    sampler.Sample(static_cast<double>(i) * frame_time_s, frames.col(i));
    if (i > 0) AlignHemispheres(skeleton, frames.col(i - 1), frames.col(i));
  }
  return frames;
}

double FrameTimeOf(const MotionClip& clip) {
  const double frame_time_s = clip.properties().frame_time_s;
  return frame_time_s > 0 ? frame_time_s : kDefaultFrameTime_s;
}

absl::StatusOr<Eigen::MatrixXd> FramesFromClip(const MotionClip& clip) {
  return FramesFromClip(clip, FrameTimeOf(clip));
}

}  // namespace gelenk
