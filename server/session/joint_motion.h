// How the joints of a session move, and what its speed limits leave for the
// next frame.
#ifndef GELENK_SERVER_SESSION_JOINT_MOTION_H_
#define GELENK_SERVER_SESSION_JOINT_MOTION_H_

#include <Eigen/Core>
#include <optional>

#include "absl/time/time.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/step_bounds.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::server {

// What the speed limits of the next frame start from. Kept only where
// SolverOptions::limit_speed asks for it.
struct JointMotion {
  // Of the last frame that was solved, on the client's clock.
  std::optional<absl::Duration> capture_time;
  // Size velocity_count, or none.
  Eigen::VectorXd velocity;
};

// Adds the fault of a motion that a client brings: a time without finite
// velocities of the skeleton's size.
void CheckMotion(const Skeleton& skeleton, const JointMotion& motion,
                 Violations& violations);

// What the limits leave until `capture_time` into `bounds`. False where nothing
// bounds, for want of a time now or before. Allocates only to grow `bounds`.
bool BoundSpeed(const Skeleton& skeleton, const JointMotion& motion,
                std::optional<absl::Duration> capture_time, StepBounds& bounds);

// Takes note of how the joints came from `before` to `after`, at
// `capture_time`. Allocates only the first time.
void NoteMotion(const Skeleton& skeleton,
                std::optional<absl::Duration> capture_time,
                const ConstVectorView& before, const ConstVectorView& after,
                JointMotion& motion);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_JOINT_MOTION_H_
