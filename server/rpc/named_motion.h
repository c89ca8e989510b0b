// Bodies, and motions of bodies, that requests name.
#ifndef GELENK_SERVER_RPC_NAMED_MOTION_H_
#define GELENK_SERVER_RPC_NAMED_MOTION_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/retarget/joint_map.h"
#include "gelenk/retarget/moving_body.h"
#include "gelenk/v1/joint_map.pb.h"
#include "gelenk/v1/motion_service.pb.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// A skeleton, with motion or without, that a request names.
struct NamedMotion {
  std::string skeleton_name;
  std::shared_ptr<const Skeleton> skeleton;
  // A column a frame.
  Eigen::MatrixXd frames = {};
  double frame_time_s = 0;
  // For a clip that is made on this body.
  std::shared_ptr<const BvhForm> form = nullptr;
  double unit_m = 0;
};

// INVALID_ARGUMENT naming `field` for a clip of too many frames.
absl::StatusOr<NamedMotion> MotionOf(const ServiceState& state,
                                     absl::string_view field,
                                     const StoredClip& stored);
// The same for the clip of that name, and what FindClip says.
absl::StatusOr<NamedMotion> MotionOf(const ServiceState& state,
                                     absl::string_view field,
                                     const std::string& clip);
// The same for a clip or a skeleton, and what FindSkeleton says.
absl::StatusOr<NamedMotion> MotionOf(const ServiceState& state,
                                     absl::string_view field,
                                     const v1::BodySource& source);

using Overrides = std::vector<JointMapOverride>;

// FAILED_PRECONDITION for a skeleton that is no body.
absl::StatusOr<MovingBody> BodyOf(absl::string_view field, NamedMotion motion,
                                  const Overrides& overrides = {});

// Both sides of a map that a request gives.
struct BothOverrides {
  Overrides source;
  Overrides target;
};
// INVALID_ARGUMENT listing what is wrong below `field`.
absl::StatusOr<BothOverrides> OverridesOf(absl::string_view field,
                                          const v1::JointMap& map,
                                          const Skeleton& source,
                                          const Skeleton& target);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_NAMED_MOTION_H_
