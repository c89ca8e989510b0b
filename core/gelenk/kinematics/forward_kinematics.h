// Joint positions in, joint frames out.
//
// One parents-first pass over flat arrays; allocates only when WorldTransforms
// grows to a larger skeleton than before. About 25 ns a joint.
#ifndef GELENK_KINEMATICS_FORWARD_KINEMATICS_H_
#define GELENK_KINEMATICS_FORWARD_KINEMATICS_H_

#include <vector>

#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// world_from_joint of every joint, in the skeleton's order.
using WorldTransforms = std::vector<RigidTransform>;

// The motion of one joint at q: what is composed on the right of
// parent_from_joint. `positions` are those of the whole skeleton.
RigidTransform JointMotion(const Skeleton& skeleton, int joint,
                           const ConstVectorView& positions);

// `positions` has size position_count. `world_from_skeleton` is where the
// actor stands.
void ForwardKinematics(const Skeleton& skeleton,
                       const ConstVectorView& positions,
                       const RigidTransform& world_from_skeleton,
                       WorldTransforms& world_from_joints);

inline void ForwardKinematics(const Skeleton& skeleton,
                              const ConstVectorView& positions,
                              WorldTransforms& world_from_joints) {
  ForwardKinematics(skeleton, positions, RigidTransform(), world_from_joints);
}

}  // namespace gelenk

#endif  // GELENK_KINEMATICS_FORWARD_KINEMATICS_H_
