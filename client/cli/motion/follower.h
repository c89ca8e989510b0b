// Sessions of one body that follow another one.
#ifndef CLIENT_CLI_MOTION_FOLLOWER_H_
#define CLIENT_CLI_MOTION_FOLLOWER_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cli/motion/body_file.h"
#include "gelenk/client/connection.h"
#include "gelenk/client/session_spec.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/retarget/humanoid.h"
#include "gelenk/retarget/joint_map.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::cli {

// One of the two.
struct FollowedBody {
  std::shared_ptr<const Skeleton> skeleton;
  // What is known of its joint map.
  std::vector<JointMapOverride> roles;
  // Its motion, which tells how its rig is meant, a column a frame; may be
  // null. Frames before the first are none of it.
  std::shared_ptr<const Eigen::MatrixXd> frames = nullptr;
  double frame_time_s = 0;
  int first_frame = 0;
};
FollowedBody FollowedBodyOf(const BodyFile& file);

// Skeletons and session, with ids of their own and a short life, EVERY_FRAME.
// Of a long clip the beginning calibrates.
client::SessionSpec FollowerSpec(const FollowedBody& source,
                                 const FollowedBody& target);

// A person with trackers, and the ids of those that there are; see
// gelenk.v1.Trackers.
struct TrackedBody {
  double height_m = kHumanoidHeightM;
  std::vector<std::string> tracker_ids;
  // Where they are in a T-pose, in the order of the ids; empty: not told.
  std::vector<RigidTransform> t_pose;
};

// The same with trackers: goal i is tracker i, lost until a frame says where it
// is and gives it a weight.
client::SessionSpec TrackedSpec(const TrackedBody& source,
                                const FollowedBody& target);

// Streams the motion of `source` through a session, frame by frame without
// look-ahead, and gives the target's poses, a column a frame. The log of the
// session goes to `record_path` unless that is empty. Errors: those of the
// service, or of a frame, with its number.
absl::StatusOr<Eigen::MatrixXd> FollowClip(
    const std::shared_ptr<client::Connection>& connection,
    const BodyFile& source, const BodyFile& target,
    const std::string& record_path = "");

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MOTION_FOLLOWER_H_
