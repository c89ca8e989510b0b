// Requests about a planar arm, for tests over the wire.
#ifndef GELENK_TESTS_TESTING_EXAMPLE_REQUESTS_H_
#define GELENK_TESTS_TESTING_EXAMPLE_REQUESTS_H_

#include <cstdint>
#include <string>

#include "gelenk/v1/kinematics_service.pb.h"
#include "gelenk/v1/session_service.pb.h"

namespace gelenk::testing {

// Places of the goals of ArmSessionRequest.
inline constexpr int kReachGoal = 0;
inline constexpr int kAimGoal = 1;

// skeletons/planar-arm: three links of 0.5 m, revolute joints "j0" .. "j2"
// about +Z without limits, the end is "tip".
v1::CreateSkeletonRequest ArmSkeletonRequest();

// A session on skeletons/planar-arm, warm, with the goals "reach" (a point, by
// the tip) and "aim" (an orientation of j1, of little weight). `id` may be
// empty.
v1::CreateSessionRequest ArmSessionRequest(const std::string& id = "");

// Slot 0, EVERY_FRAME.
v1::AttachSession AttachRequest(const std::string& session);

// A frame that moves "reach" only.
v1::TargetFrame ReachFrame(int64_t sequence_number, double x_m, double y_m,
                           int slot = 0);

// A frame that names both goals, on a path that goes round in about 60 frames
// and stays in reach.
v1::TargetFrame WholeFrame(int64_t sequence_number, int slot = 0);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_EXAMPLE_REQUESTS_H_
