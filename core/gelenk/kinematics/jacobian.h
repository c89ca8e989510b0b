// How an effector moves when the joints do.
#ifndef GELENK_KINEMATICS_JACOBIAN_H_
#define GELENK_KINEMATICS_JACOBIAN_H_

#include <Eigen/Core>

#include "gelenk/kinematics/forward_kinematics.h"

namespace gelenk {

// The geometric Jacobian, 6 x velocity_count: rows 0-2 the velocity of the
// effector's origin, m/s, rows 3-5 its angular velocity, rad/s, both in world
// axes. Columns follow JointType's velocities; a mimic joint's motion is in
// the column of the joint it follows.
//
// `world_from_joints` is ForwardKinematics at `positions`. Cost: linear in the
// depth of the effector. `jacobian` is resized and overwritten.
void ComputeJacobian(const Skeleton& skeleton, const ConstVectorView& positions,
                     const WorldTransforms& world_from_joints,
                     const EffectorFrame& effector,
                     Eigen::Matrix<double, 6, Eigen::Dynamic>& jacobian);

}  // namespace gelenk

#endif  // GELENK_KINEMATICS_JACOBIAN_H_
