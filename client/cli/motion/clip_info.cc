#include "client/cli/motion/clip_info.h"

#include <Eigen/Core>
#include <map>

#include "absl/strings/str_cat.h"
#include "client/cli/text/table.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/gait_phase.h"

namespace gelenk::cli {
namespace {

// Tracks and keys of one interpolation.
struct TrackCount {
  int tracks = 0;
  int keys = 0;
};

std::map<std::string, TrackCount> CountTracks(const MotionClip& clip) {
  std::map<std::string, TrackCount> counts;
  for (int i = 0; i < clip.track_count(); ++i) {
    const JointTrack& track = clip.track(i);
    TrackCount& count =
        counts[std::string(InterpolationName(track.interpolation))];
    ++count.tracks;
    count.keys += track.key_count();
  }
  return counts;
}

// Frames of a clip that is sampled evenly, 0 of one that is not.
int FrameCount(const MotionClip& clip) {
  const double frame_time_s = clip.properties().frame_time_s;
  if (!(frame_time_s > 0)) return 0;
  return static_cast<int>(clip.duration_s() / frame_time_s + 1.5);
}

// How far the root goes, all along and in a straight line, m; unset where it
// does not move.
struct RootWay {
  double path_m = 0;
  double distance_m = 0;
};
RootWay WayOfRoot(const MotionClip& clip) {
  RootWay way;
  const int index = clip.FindTrack(0, PosePartKind::kNumbers);
  if (index < 0 || clip.skeleton()->joint(0).type != JointType::kFree) {
    return way;
  }
  const Eigen::MatrixXd& places = clip.track(index).values;
  for (Eigen::Index i = 1; i < places.cols(); ++i) {
    way.path_m += (places.col(i) - places.col(i - 1)).norm();
  }
  way.distance_m = (places.rightCols(1) - places.leftCols(1)).norm();
  return way;
}

// Steps of a gait; 0 for what is none.
int StepCount(const MotionClip& clip) {
  const absl::StatusOr<GaitPhase> phase = FindGaitPhase(clip);
  return phase.ok() ? static_cast<int>(phase->strikes_s.size()) : 0;
}

std::string AnimationName(const MotionFile& file, size_t index) {
  const std::string& name = file.animation_names[index];
  return absl::StrCat(index, " ", name.empty() ? "(no name)" : name);
}

}  // namespace

std::string ClipInfoText(const MotionFile& file) {
  const MotionClip& clip = file.clip;
  const RootWay way = WayOfRoot(clip);
  Facts facts;
  facts.Add("duration, s", Fixed(clip.duration_s(), 3));
  if (FrameCount(clip) > 0) {
    facts.Add("frames", absl::StrCat(FrameCount(clip), " of ",
                                     clip.properties().frame_time_s, " s"));
  }
  facts.Add("joints", absl::StrCat(clip.skeleton()->joint_count()));
  facts.Add("metres per unit", absl::StrCat(file.unit_m));
  for (const auto& [name, count] : CountTracks(clip)) {
    facts.Add(absl::StrCat(name, " tracks"),
              absl::StrCat(count.tracks, " with ", count.keys, " keys"));
  }
  facts.Add("way of the root, m",
            absl::StrCat(Fixed(way.path_m, 3), ", ", Fixed(way.distance_m, 3),
                         " in a straight line"));
  const int steps = StepCount(clip);
  facts.Add("strikes of feet", steps > 0 ? absl::StrCat(steps) : "none found");
  for (size_t i = 0; i < file.animation_names.size(); ++i) {
    facts.Add(i == 0 ? "animations" : "", AnimationName(file, i));
  }
  std::string text = facts.ToString();
  for (const std::string& warning : file.warnings) {
    absl::StrAppend(&text, warning, "\n");
  }
  return text;
}

Json ClipInfoJson(const MotionFile& file) {
  const MotionClip& clip = file.clip;
  const RootWay way = WayOfRoot(clip);
  Json tracks = Json::object();
  for (const auto& [name, count] : CountTracks(clip)) {
    tracks[name] = {{"tracks", count.tracks}, {"keys", count.keys}};
  }
  return {{"duration_s", clip.duration_s()},
          {"frames", FrameCount(clip)},
          {"frame_time_s", clip.properties().frame_time_s},
          {"joints", clip.skeleton()->joint_count()},
          {"unit_m", file.unit_m},
          {"tracks", tracks},
          {"root_path_m", way.path_m},
          {"root_distance_m", way.distance_m},
          {"strikes", StepCount(clip)},
          {"animations", file.animation_names},
          {"warnings", file.warnings}};
}

}  // namespace gelenk::cli
