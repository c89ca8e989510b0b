// What only motion tells about a rig: the axes of its hinges and the soles of
// its feet.
#ifndef GELENK_RETARGET_CLIP_ANATOMY_H_
#define GELENK_RETARGET_CLIP_ANATOMY_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "gelenk/retarget/joint_map.h"
#include "gelenk/retarget/reference_pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// Turns the anatomy of upper and lower limbs about their bones so that elbows
// and knees bend about their anatomical axes: left elbow -Y, right elbow +Y,
// knees +X. Limbs that hardly bend, or about no single axis, stay as they are.
// Returns what was done. Cost: linear, at most 400 frames.
std::vector<std::string> AlignHinges(const Skeleton& skeleton,
                                     const JointMap& map, const ClipView& clip,
                                     std::vector<Eigen::Quaterniond>& anatomy);

// Tilts the anatomy of feet and toes so that they are level where the clip has
// them at rest and low. `foot_from_ball` by side; `leg_length` scales the
// thresholds; a tilt of less than `min_tilt_rad` is noise. Returns what was
// done.
std::vector<std::string> LevelFeet(
    const Skeleton& skeleton, const JointMap& map, const ClipView& clip,
    const std::array<Eigen::Vector3d, 2>& foot_from_ball, double leg_length,
    double min_tilt_rad, std::vector<Eigen::Quaterniond>& anatomy);

}  // namespace gelenk

#endif  // GELENK_RETARGET_CLIP_ANATOMY_H_
