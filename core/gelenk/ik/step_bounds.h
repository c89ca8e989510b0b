// How far each degree of freedom may move in one solve: an interval about the
// start. What keeps a stream's joints from moving faster than they can.
//
// The solver keeps it as it keeps limits: inside its steps, so that the other
// joints make up for one that may go no further. A rotation of a spherical or
// free joint may turn by the least of its six bounds, about any axis.
#ifndef GELENK_IK_STEP_BOUNDS_H_
#define GELENK_IK_STEP_BOUNDS_H_

#include <Eigen/Core>

#include "absl/time/time.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// Size velocity_count each, rad or m; lower <= 0 <= upper.
struct StepBounds {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
};

// What JointLimits::max_velocity and max_acceleration leave for a frame that
// comes `interval` after the one before, in which the joints moved at
// `velocity` (size velocity_count, rad/s or m/s). A degree of freedom without
// such limits is unbounded. A joint that is faster than it may be brakes as
// hard as it can; where braking takes longer than the frame, it still may stand
// still. Allocates nothing once `bounds` has been used for such a skeleton.
void SpeedLimits(const Skeleton& skeleton, absl::Duration interval,
                 const ConstVectorView& velocity, StepBounds& bounds);

// True when a joint has a max_velocity or max_acceleration.
bool HasSpeedLimits(const Skeleton& skeleton);

}  // namespace gelenk

#endif  // GELENK_IK_STEP_BOUNDS_H_
