// Joint limits read off recorded motion: what the body did, and a little more.
//
// Per joint the range over the clip, widened by a margin:
//   revolute, prismatic, planar   lower and upper per coordinate;
//   spherical, free               a swing cone about the joint's bone and a
//                                 range of twist about it, the twist followed
//                                 over time so that it may pass half a turn;
//   free below the root           also its translations. The root goes where
//                                 it likes.
// The bone of a joint points to its first child that is elsewhere, else to its
// first end effector, else along +Y; a free root turns about the world's up, so
// that its twist is its heading and its swing its lean.
#ifndef GELENK_MOTION_CLIP_LIMITS_H_
#define GELENK_MOTION_CLIP_LIMITS_H_

#include <Eigen/Core>
#include <memory>
#include <numbers>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct ClipLimitMargins {
  double angle_rad = 5 * std::numbers::pi / 180;
  double length_m = 0.01;
};

// A swing beyond this says too little about the twist: at half a turn it is
// undefined.
inline constexpr double kMaxSwingWithTwistRad = 170 * std::numbers::pi / 180;

struct ClipLimits {
  // As given, with the limits of position and the axes they refer to replaced;
  // velocity and acceleration limits stay. Positions mean the same on both.
  std::shared_ptr<const Skeleton> skeleton;
  // Joints without a limit of twist: those that twist by a whole turn, and
  // those that swing beyond kMaxSwingWithTwistRad.
  std::vector<int> twisting_whole_turn;
  std::vector<int> swinging_half_turn;
};

// `positions` holds one pose a column, position_count rows, each of which has
// passed CheckPositions. INVALID_ARGUMENT when there is no pose or the rows do
// not fit. Every pose lies inside the result. Cost: linear.
absl::StatusOr<ClipLimits> LimitToClip(
    const Skeleton& skeleton,
    const Eigen::Ref<const Eigen::MatrixXd>& positions,
    const ClipLimitMargins& margins = {});

}  // namespace gelenk

#endif  // GELENK_MOTION_CLIP_LIMITS_H_
