#include "tests/testing/followed_body.h"

#include <array>

#include "convert/geometry.h"
#include "convert/pose.h"
#include "convert/skeleton.h"
#include "gelenk/retarget/humanoid.h"
#include "gelenk/retarget/tracker_goals.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk::testing {
namespace {

constexpr double kHeroHeight = 1.5;

v1::CreateSkeletonRequest SkeletonRequest(const std::string& id,
                                          const Skeleton& skeleton) {
  v1::CreateSkeletonRequest request;
  request.set_skeleton_id(id);
  convert::ToProto(skeleton, request.mutable_skeleton());
  return request;
}

v1::CreateSessionRequest SessionOnHero() {
  v1::CreateSessionRequest request;
  request.mutable_session()->set_skeleton("skeletons/hero");
  return request;
}

}  // namespace

BodyClip WalkClip(int frames) {
  return *BodyClipFromBvh(WalkingBvh(frames), "walk");
}

v1::CreateSkeletonRequest WalkerRequest(const BodyClip& clip) {
  return SkeletonRequest("walker", *clip.model->skeleton);
}

v1::CreateSkeletonRequest HeroRequest() {
  return SkeletonRequest("hero", *MakeHumanoid(kHeroHeight));
}

std::shared_ptr<const BodyModel> HeroModel() {
  const auto skeleton = MakeHumanoid(kHeroHeight);
  return *MakeBodyModel(skeleton, *ProposeJointMap(*skeleton));
}

v1::CreateSessionRequest FollowerRequest(const BodyClip& clip) {
  v1::CreateSessionRequest request = SessionOnHero();
  v1::Retargeting* retargeting =
      request.mutable_session()->mutable_retargeting();
  retargeting->set_source_skeleton("skeletons/walker");
  retargeting->set_frame_time_s(clip.frame_time_s);
  v1::BodyCalibration* calibration = retargeting->mutable_source_calibration();
  calibration->mutable_positions()->Assign(
      clip.positions.data(), clip.positions.data() + clip.positions.size());
  calibration->set_frame_time_s(clip.frame_time_s);
  return request;
}

v1::CreateSessionRequest TrackedRequest() {
  v1::CreateSessionRequest request = SessionOnHero();
  request.mutable_session()->mutable_retargeting()->mutable_trackers();
  for (absl::string_view id : kTrackerIds) {
    v1::Goal* goal = request.mutable_session()->add_goals();
    goal->set_goal_id(std::string(id));
    goal->set_weight(0);
    goal->mutable_pose()->set_end_effector_id("head");
  }
  return request;
}

v1::TargetFrame SourceFrame(const BodyClip& clip, int number) {
  v1::TargetFrame frame;
  frame.set_sequence_number(number);
  convert::ToProto(clip.positions.col(number - 1), frame.mutable_source_pose());
  return frame;
}

v1::TargetFrame TrackedFrame(const Actor& actor, int number) {
  const TrackerFrame trackers =
      TrackersOn(*actor.model, actor.positions.col(number - 1), true);
  const std::array<RigidTransform, 6> places = {
      *trackers.head,  *trackers.hands[0], *trackers.hands[1],
      *trackers.waist, *trackers.feet[0],  *trackers.feet[1]};
  v1::TargetFrame frame;
  frame.set_sequence_number(number);
  for (int i = 0; i < 6; ++i) {
    v1::GoalTarget* target = frame.add_targets();
    target->set_goal_index(i);
    if (number == 1) target->set_weight(1);
    convert::ToProto(places[i], target->mutable_world_pose());
  }
  return frame;
}

}  // namespace gelenk::testing
