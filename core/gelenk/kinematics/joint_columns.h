// How one joint moves what it carries: what Jacobians are made of.
#ifndef GELENK_KINEMATICS_JOINT_COLUMNS_H_
#define GELENK_KINEMATICS_JOINT_COLUMNS_H_

#include <Eigen/Core>
#include <array>

#include "gelenk/kinematics/forward_kinematics.h"

namespace gelenk {

// One degree of freedom of a joint, at some pose.
struct JointColumn {
  // Index into a velocity; a mimic joint's is that of the joint it follows.
  int column = -1;
  // Turns about the axis through the joint's origin, else slides along it.
  bool turns = false;
  // World frame; as long as the motion per unit of velocity.
  Eigen::Vector3d world_axis = Eigen::Vector3d::Zero();

  // What it does to a point at `world_arm` from the joint's origin: velocity,
  // then angular velocity.
  Eigen::Matrix<double, 6, 1> Twist(const Eigen::Vector3d& world_arm) const {
    Eigen::Matrix<double, 6, 1> twist;
    if (turns) {
      twist << world_axis.cross(world_arm), world_axis;
    } else {
      twist << world_axis, Eigen::Vector3d::Zero();
    }
    return twist;
  }
};

inline constexpr int kMaxJointColumns = 6;
using JointColumns = std::array<JointColumn, kMaxJointColumns>;

// Fills the degrees of freedom of joint `index` and returns their number.
// `world_from_joints` is ForwardKinematics at `positions`.
int ListJointColumns(const Skeleton& skeleton, const ConstVectorView& positions,
                     const WorldTransforms& world_from_joints, int index,
                     JointColumns& columns);

}  // namespace gelenk

#endif  // GELENK_KINEMATICS_JOINT_COLUMNS_H_
