#include "tests/testing/retarget_runs.h"

#include <algorithm>
#include <utility>

#include "gelenk/retarget/retarget_clip.h"

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
  std::vector<RetargetReport> reports;
  if (way == RetargetWay::kOnline) {
    run.positions.resize(target->skeleton->position_count(), count);
    absl::StatusOr<std::unique_ptr<Retargeter>> retargeter =
        Retargeter::Create(source.clip.model, target, options);
    if (!retargeter.ok()) return retargeter.status();
    for (int f = 0; f < count; ++f) {
      const absl::Status status = (*retargeter)
                                      ->Retarget(source.clip.positions.col(f),
                                                 source.clip.frame_time_s);
      if (!status.ok()) return status;
      run.positions.col(f) = (*retargeter)->positions();
      reports.push_back((*retargeter)->report());
    }
  } else {
    absl::StatusOr<RetargetedClip> clip =
        RetargetClip(source.clip.model, target, source.clip.positions,
                     source.clip.frame_time_s, options);
    if (!clip.ok()) return clip.status();
    run.positions = std::move(clip->positions);
    reports = std::move(clip->reports);
  }
  double hands = 0;
  for (const RetargetReport& report : reports) {
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
