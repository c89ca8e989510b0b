#include "tests/testing/retarget_runs.h"

#include <algorithm>
#include <utility>

namespace gelenk::testing {

SourceClip MakeSource(BodyClip clip) {
  SourceClip source;
  source.poses = BodyPosesOf(*clip.model, clip.positions);
  source.labels = LabelContacts(FootPointsOf(source.poses), clip.frame_time_s,
                                FeetOf(*clip.model));
  source.quality = MeasureMotion({*clip.model, source.poses, clip.frame_time_s},
                                 source.labels);
  source.clip = std::move(clip);
  return source;
}

absl::StatusOr<RetargetRun> RunRetarget(
    const SourceClip& source, const std::shared_ptr<const BodyModel>& target,
    RetargetWay way) {
  RetargetOptions options;
  if (way == RetargetWay::kCopy) {
    options.place_limbs = false;
    options.keep_limits = false;
  }
  RetargetRun run;
  const int count = source.clip.frame_count();
  run.positions.resize(target->skeleton->position_count(), count);
  absl::StatusOr<std::unique_ptr<Retargeter>> retargeter =
      Retargeter::Create(source.clip.model, target, options);
  if (!retargeter.ok()) return retargeter.status();
  double hands = 0;
  for (int f = 0; f < count; ++f) {
    if (way == RetargetWay::kCopy) {
      // On the floor of the whole clip: the copy is given the benefit of
      // look-ahead.
      (*retargeter)
          ->RetargetBody(source.poses[f], source.labels.frames[f],
                         source.labels.floor_m, source.clip.frame_time_s);
    } else {
      const absl::Status status = (*retargeter)
                                      ->Retarget(source.clip.positions.col(f),
                                                 source.clip.frame_time_s);
      if (!status.ok()) return status;
    }
    const RetargetReport& report = (*retargeter)->report();
    run.positions.col(f) = (*retargeter)->positions();
    for (int side : kSides) {
      if (target->arms[side].Total() > 0) {
        hands += report.hand_error_m[side] / target->arms[side].Total() / 2;
      }
    }
    if (report.limit_excess > 0) run.limited_part += 1.0 / count;
  }
  run.hand_error = hands / count;
  for (int f = 0; f < count; ++f) {
    run.limit_excess =
        std::max(run.limit_excess,
                 LimitExcess(*target->skeleton, run.positions.col(f), nullptr));
  }
  const std::vector<BodyPose> poses = BodyPosesOf(*target, run.positions);
  const FlatGround ground;
  const BodyMotionView made = {*target, poses, source.clip.frame_time_s};
  run.quality = MeasureMotion(made, source.labels, &ground);
  run.comparison = CompareMotion(
      {*source.clip.model, source.poses, source.clip.frame_time_s},
      source.quality, made, run.quality);
  return run;
}

}  // namespace gelenk::testing
