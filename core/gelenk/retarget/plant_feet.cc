#include "gelenk/retarget/plant_feet.h"

#include <utility>

#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/pose_part.h"
#include "gelenk/retarget/moving_body.h"

namespace gelenk {
namespace {

// The joints from the root down to both toes.
std::vector<bool> CarriesLegs(const BodyModel& model) {
  const Skeleton& skeleton = *model.skeleton;
  std::vector<bool> carries(skeleton.joint_count(), false);
  for (const LegRoles& leg : kLegRoles) {
    for (BodyRole end : {leg.foot, leg.toe}) {
      for (int joint = model.map.joint(end); joint >= 0;
           joint = skeleton.span(joint).parent) {
        carries[joint] = true;
      }
    }
  }
  return carries;
}

}  // namespace

absl::StatusOr<PlantedClip> PlantFeet(const MotionClip& clip) {
  const double frame_time_s = FrameTimeOf(clip);
  absl::StatusOr<Eigen::MatrixXd> frames = FramesFromClip(clip, frame_time_s);
  if (!frames.ok()) return frames.status();
  const absl::StatusOr<MovingBody> body =
      MakeMovingBody(clip.skeleton(), *std::move(frames), frame_time_s);
  if (!body.ok()) return body.status();
  if (!body->model->map.HasLegs()) {
    return absl::FailedPreconditionError(
        "clip: its skeleton has no two legs to stand on");
  }
  const absl::StatusOr<Eigen::MatrixXd> planted =
      RetargetBody(*body, body->model, LookAhead::kWholeClip, {});
  if (!planted.ok()) return planted.status();
  const std::vector<bool> carries = CarriesLegs(*body->model);
  Eigen::MatrixXd positions = body->positions;
  for (const PosePart& part : PosePartsOf(*clip.skeleton())) {
    if (!carries[part.joint]) continue;
    positions.middleRows(part.position_offset, part.position_count) =
        planted->middleRows(part.position_offset, part.position_count);
  }
  ClipProperties properties = clip.properties();
  properties.frame_time_s = frame_time_s;
  absl::StatusOr<MotionClip> made =
      ClipFromFrames(clip.skeleton(), positions, std::move(properties));
  if (!made.ok()) return made.status();
  return PlantedClip{*std::move(made), body->notes};
}

}  // namespace gelenk
