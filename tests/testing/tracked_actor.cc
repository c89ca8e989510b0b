#include "tests/testing/tracked_actor.h"

#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/retarget/humanoid.h"
#include "gelenk/retarget/retarget_clip.h"
#include "tests/testing/body_clips.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk::testing {

TrackerFrame TrackersOn(const BodyModel& model,
                        const Eigen::VectorXd& positions, bool with_lower) {
  WorldTransforms at;
  ForwardKinematics(*model.skeleton, positions, at);
  const auto part = [&](BodyRole role) { return at[model.map.joint(role)]; };
  TrackerFrame frame;
  frame.head = part(BodyRole::kHead);
  frame.hands = {part(BodyRole::kLeftHand), part(BodyRole::kRightHand)};
  if (!with_lower) return frame;
  frame.waist = part(BodyRole::kPelvis);
  frame.feet = {part(BodyRole::kLeftFoot), part(BodyRole::kRightFoot)};
  return frame;
}

Actor WalkingActor(int frames) {
  const auto clip = BodyClipFromBvh(WalkingBvh(frames), "walk");
  const auto skeleton = MakeHumanoid();
  Actor actor;
  actor.model = *MakeBodyModel(skeleton, *ProposeJointMap(*skeleton));
  actor.positions = RetargetClip(clip->model, actor.model, clip->positions,
                                 clip->frame_time_s)
                        ->positions;
  return actor;
}

}  // namespace gelenk::testing
