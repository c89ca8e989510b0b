#include "gelenk/motion/clip_cut.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/first_frame.h"
#include "gelenk/motion/sampler.h"

namespace gelenk {
namespace {

// The keys of a track of steps or lines within the cut, and one at each end.
JointTrack CutTrack(const TrackCurve& curve, double start_s, double end_s,
                    Eigen::VectorXd& positions) {
  const JointTrack& track = curve.track();
  JointTrack cut{.joint = track.joint,
                 .kind = track.kind,
                 .interpolation = track.interpolation};
  std::vector<double> at_s = {start_s};
  for (double time_s : track.times_s) {
    if (time_s > start_s && time_s < end_s) at_s.push_back(time_s);
  }
  at_s.push_back(end_s);
  const PosePart& part = curve.part();
  cut.values.resize(part.position_count,
                    static_cast<Eigen::Index>(at_s.size()));
  int cursor = 0;
  for (size_t i = 0; i < at_s.size(); ++i) {
    curve.Sample(at_s[i], cursor, positions.data());
    cut.values.col(static_cast<Eigen::Index>(i)) =
        positions.segment(part.position_offset, part.position_count);
    cut.times_s.push_back(at_s[i] - start_s);
  }
  return cut;
}

// A cubic between the cuts, frame by frame and at the end.
JointTrack SampleTrack(const TrackCurve& curve, double start_s, double end_s,
                       double frame_time_s, Eigen::VectorXd& positions) {
  JointTrack sampled{.joint = curve.track().joint, .kind = curve.track().kind};
  const double length_s = end_s - start_s;
  const int steps =
      std::max(1, static_cast<int>(std::ceil(length_s / frame_time_s - 1e-3)));
  const PosePart& part = curve.part();
  sampled.values.resize(part.position_count, steps + 1);
  int cursor = 0;
  for (int i = 0; i <= steps; ++i) {
    const double at_s = i == steps ? length_s : i * frame_time_s;
    curve.Sample(start_s + at_s, cursor, positions.data());
    sampled.values.col(i) =
        positions.segment(part.position_offset, part.position_count);
    sampled.times_s.push_back(at_s);
  }
  return sampled;
}

}  // namespace

absl::StatusOr<MotionClip> CropClip(const MotionClip& clip, double start_s,
                                    double end_s) {
  Violations violations;
  if (!(start_s >= 0 && start_s < clip.duration_s())) {
    violations.Add("start_s",
                   absl::StrFormat("want at least 0 and less than %g, got %g",
                                   clip.duration_s(), start_s));
  }
  if (!(end_s > start_s && end_s <= clip.duration_s())) {
    violations.Add("end_s",
                   absl::StrFormat("want more than the start and at most %g, "
                                   "got %g",
                                   clip.duration_s(), end_s));
  }
  const double frame_time_s = FrameTimeOf(clip);
  if (violations.empty() && (end_s - start_s) / frame_time_s > kMaxClipFrames) {
    violations.Add("end_s",
                   absl::StrFormat("want at most %d frames", kMaxClipFrames));
  }
  if (!violations.empty()) return violations.ToStatus();
  Eigen::VectorXd positions = clip.properties().base_positions;
  std::vector<JointTrack> tracks;
  for (int i = 0; i < clip.track_count(); ++i) {
    const Interpolation interpolation = clip.track(i).interpolation;
    const bool is_simple = interpolation == Interpolation::kStep ||
                           interpolation == Interpolation::kLinear;
    tracks.push_back(is_simple
                         ? CutTrack(clip.curve(i), start_s, end_s, positions)
                         : SampleTrack(clip.curve(i), start_s, end_s,
                                       frame_time_s, positions));
  }
  ClipProperties properties = clip.properties();
  properties.seam_s.reset();
  return MotionClip::Create(clip.skeleton(), std::move(tracks),
                            std::move(properties));
}

absl::StatusOr<MotionPart> CutToMotion(const MotionClip& clip) {
  const absl::StatusOr<Eigen::MatrixXd> frames = FramesFromClip(clip);
  if (!frames.ok()) return frames.status();
  const int before = CountFramesBeforeMotion(*clip.skeleton(), *frames);
  if (before == 0) return MotionPart{clip};
  ClipProperties properties = clip.properties();
  properties.frame_time_s = FrameTimeOf(clip);
  absl::StatusOr<MotionClip> motion = ClipFromFrames(
      clip.skeleton(), frames->rightCols(frames->cols() - before),
      std::move(properties));
  if (!motion.ok()) return motion.status();
  return MotionPart{*std::move(motion), before};
}

std::string LeftOutText(int frames_before) {
  if (frames_before == 0) return "";
  if (frames_before == 1) {
    return "frame 0 is no part of the motion and left out";
  }
  return absl::StrCat("frames 0 to ", frames_before - 1,
                      " are no part of the motion and left out");
}

absl::StatusOr<MotionClip> ResampleClip(const MotionClip& clip,
                                        double frame_time_s) {
  const absl::StatusOr<Eigen::MatrixXd> frames =
      FramesFromClip(clip, frame_time_s);
  if (!frames.ok()) return frames.status();
  ClipProperties properties = clip.properties();
  properties.frame_time_s = frame_time_s;
  return ClipFromFrames(clip.skeleton(), *frames, std::move(properties));
}

absl::StatusOr<MotionClip> WarpClip(const MotionClip& clip,
                                    const std::vector<WarpKey>& keys) {
  Violations violations;
  if (keys.size() < 2) {
    violations.Add("keys",
                   absl::StrCat("want at least two, got ", keys.size()));
  }
  for (size_t i = 0; i < keys.size(); ++i) {
    const bool is_first = i == 0;
    if (!(std::isfinite(keys[i].time_s) &&
          (is_first ? keys[i].time_s == 0
                    : keys[i].time_s > keys[i - 1].time_s))) {
      violations.Add(absl::StrCat("keys[", i, "].time_s"),
                     absl::StrCat(is_first ? "want 0" : "want more than before",
                                  ", got ", keys[i].time_s));
    }
    if (!(std::isfinite(keys[i].clip_time_s) &&
          (is_first || keys[i].clip_time_s > keys[i - 1].clip_time_s))) {
      violations.Add(
          absl::StrCat("keys[", i, "].clip_time_s"),
          absl::StrCat("want more than before, got ", keys[i].clip_time_s));
    }
  }
  const double frame_time_s = FrameTimeOf(clip);
  if (violations.empty() &&
      !(keys.back().time_s / frame_time_s < kMaxClipFrames)) {
    violations.Add("keys", absl::StrFormat("want at most %d frames, got %g s",
                                           kMaxClipFrames, keys.back().time_s));
  }
  if (!violations.empty()) return violations.ToStatus();
  const int steps =
      static_cast<int>(std::floor(keys.back().time_s / frame_time_s + 1e-3));
  Eigen::MatrixXd frames(clip.skeleton()->position_count(), steps + 1);
  Sampler sampler(clip);
  size_t next = 1;
  for (int i = 0; i <= steps; ++i) {
    const double time_s = i * frame_time_s;
    while (next + 1 < keys.size() && keys[next].time_s <= time_s) ++next;
    const WarpKey& a = keys[next - 1];
    const WarpKey& b = keys[next];
    const double u = (time_s - a.time_s) / (b.time_s - a.time_s);
    sampler.Sample(a.clip_time_s + u * (b.clip_time_s - a.clip_time_s),
                   frames.col(i));
  }
  ClipProperties properties = clip.properties();
  properties.frame_time_s = frame_time_s;
  properties.seam_s.reset();
  return ClipFromFrames(clip.skeleton(), frames, std::move(properties));
}

}  // namespace gelenk
