// The range of every number of q, once all limits are put together.
#ifndef GELENK_SKELETON_POSITION_BOUNDS_H_
#define GELENK_SKELETON_POSITION_BOUNDS_H_

#include <Eigen/Core>

#include "absl/types/span.h"
#include "gelenk/skeleton/joint.h"

namespace gelenk {

struct JointSpan;

// Infinite where there is no limit, and for quaternions.
struct PositionBounds {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
};

// The limits of each joint, narrowed by those of the joints that mimic it.
// Where a mimic's contradict those of the joint that it follows, the latter
// stand. Joints and their spans as in a Skeleton.
PositionBounds BoundPositions(absl::Span<const Joint> joints,
                              absl::Span<const JointSpan> spans,
                              int position_count);

}  // namespace gelenk

#endif  // GELENK_SKELETON_POSITION_BOUNDS_H_
