// What a driver tells a session before a solve.
#ifndef GELENK_SERVER_SESSION_INPUT_FRAME_H_
#define GELENK_SERVER_SESSION_INPUT_FRAME_H_

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "absl/types/span.h"
#include "gelenk/ik/goal.h"
#include "gelenk/math/rigid_transform.h"

namespace gelenk::server {

// New target, new weight, or both, of one goal.
struct GoalUpdate {
  int goal_index = 0;
  std::optional<GoalTarget> target;
  std::optional<double> weight;
};

// Reused from frame to frame, so that its memory is.
struct InputFrame {
  // Strictly increasing; unset for calls that are not numbered.
  std::optional<int64_t> sequence_number;
  // Rare: makes the new goals from the present ones, applied first.
  std::function<absl::StatusOr<std::vector<Goal>>(absl::Span<const Goal>)>
      patch;
  std::vector<GoalUpdate> updates;
  std::optional<RigidTransform> world_from_skeleton;
  // On the client's clock.
  std::optional<absl::Duration> capture_time;
  // Of the body that the session follows; kept for its memory when there is
  // none.
  bool has_source_pose = false;
  Eigen::VectorXd source_pose;
  // Nobody sent it: it asks what stands for a frame that did not come. The
  // session says what its capture time is.
  bool is_fill = false;
  // Set by the session: bounds the joints' speed where it wants that, and is
  // the time of a source's motion. The capture time, unless frames are timed by
  // their arrivals.
  std::optional<absl::Duration> motion_time;

  void Clear() {
    sequence_number.reset();
    patch = nullptr;
    updates.clear();
    world_from_skeleton.reset();
    capture_time.reset();
    has_source_pose = false;
    is_fill = false;
    motion_time.reset();
  }
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_INPUT_FRAME_H_
