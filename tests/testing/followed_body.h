// Sessions that follow a walking body, for tests over the wire.
#ifndef GELENK_TESTS_TESTING_FOLLOWED_BODY_H_
#define GELENK_TESTS_TESTING_FOLLOWED_BODY_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "gelenk/v1/kinematics_service.pb.h"
#include "gelenk/v1/session_service.pb.h"
#include "tests/testing/body_clips.h"
#include "tests/testing/tracked_actor.h"

namespace gelenk::testing {

// The walk of WalkingBvh.
BodyClip WalkClip(int frames);

// skeletons/walker, of the clip, and skeletons/hero: the humanoid, 1.5 m tall.
v1::CreateSkeletonRequest WalkerRequest(const BodyClip& clip);
v1::CreateSkeletonRequest HeroRequest();
std::shared_ptr<const BodyModel> HeroModel();

// A session on the hero that follows the walker, calibrated by the clip.
v1::CreateSessionRequest FollowerRequest(const BodyClip& clip);
// A session on the hero that follows six trackers.
v1::CreateSessionRequest TrackedRequest();

// Frame `number`, from 1, of the clip, and what trackers on the actor see.
v1::TargetFrame SourceFrame(const BodyClip& clip, int number);
v1::TargetFrame TrackedFrame(const Actor& actor, int number);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_FOLLOWED_BODY_H_
