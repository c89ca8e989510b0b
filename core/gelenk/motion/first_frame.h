// Finds clips whose first frame is no part of the motion: many conversions put
// the rest pose there, and the body jumps out of it by a quarter turn or more.
#ifndef GELENK_MOTION_FIRST_FRAME_H_
#define GELENK_MOTION_FIRST_FRAME_H_

#include <Eigen/Core>
#include <optional>

#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct FirstFrameJump {
  // The joint that turns most from frame 0 to frame 1, and by how much.
  int joint = -1;
  double angle_rad = 0;
  // The median of that largest turn over the next kTypicalFrames pairs of
  // frames.
  double typical_rad = 0;
};

// A jump is a turn by at least this, and by so many times the typical one: fast
// motion sampled slowly has large turns everywhere. The next pair alone does
// not tell: bodies often stand still for a moment, or are still on their way
// out of the rest pose.
inline constexpr double kMinJumpRad = 0.26;
inline constexpr double kMinJumpRatio = 4;
inline constexpr int kTypicalFrames = 11;

// `positions` holds one pose a column. Unset when the clip begins smoothly or
// has fewer than three frames. Cost: linear.
std::optional<FirstFrameJump> FindFirstFrameJump(
    const Skeleton& skeleton,
    const Eigen::Ref<const Eigen::MatrixXd>& positions);

// How many frames at the start are none of the motion: 0, or frame 0 and the
// frames of the way out of it, each of which jumps in the same sense. A
// conversion that changed the rate or smoothed the clip made a jump of one
// frame one of several; what filters a clip should leave all of them out, or it
// smears them over the first frames of the motion. At most kMaxWayFrames and
// all but two of the frames. Cost: linear.
inline constexpr int kMaxWayFrames = 8;
int CountFramesBeforeMotion(const Skeleton& skeleton,
                            const Eigen::Ref<const Eigen::MatrixXd>& positions);

}  // namespace gelenk

#endif  // GELENK_MOTION_FIRST_FRAME_H_
