// Where the bones point.
#ifndef GELENK_MOTION_BONE_AXES_H_
#define GELENK_MOTION_BONE_AXES_H_

#include <Eigen/Core>
#include <vector>

#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// Per joint, in its own frame, unit: the direction to its first child that is
// elsewhere, else to its first end effector that is, else +Y. Cost: linear.
std::vector<Eigen::Vector3d> BoneAxes(const Skeleton& skeleton);

}  // namespace gelenk

#endif  // GELENK_MOTION_BONE_AXES_H_
