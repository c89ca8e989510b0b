#include "gelenk/kinematics/forward_kinematics.h"

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

RigidTransform PlanarMotion(const Joint& joint, const double* q) {
  const Eigen::Matrix3d basis = PlanarBasis(joint.axis);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(q[2], joint.axis)),
          basis.col(0) * q[0] + basis.col(1) * q[1]};
}

}  // namespace

RigidTransform JointMotion(const Skeleton& skeleton, int index,
                           const ConstVectorView& positions) {
  const Joint& joint = skeleton.joint(index);
  const int offset = skeleton.span(index).position_offset;
  // Fixed and mimic joints own no numbers.
  const double* q = offset < 0 ? nullptr : positions.data() + offset;
  switch (joint.type) {
    case JointType::kFixed:
      return {};
    case JointType::kRevolute:
      return {Eigen::Quaterniond(Eigen::AngleAxisd(
                  ScalarPosition(skeleton, positions, index), joint.axis)),
              Eigen::Vector3d::Zero()};
    case JointType::kPrismatic:
      return {Eigen::Quaterniond::Identity(),
              joint.axis * ScalarPosition(skeleton, positions, index)};
    case JointType::kSpherical:
      return {QuaternionXyzw(q), Eigen::Vector3d::Zero()};
    case JointType::kPlanar:
      return PlanarMotion(joint, q);
    case JointType::kFree:
      return {QuaternionXyzw(q + 3), Eigen::Vector3d(q[0], q[1], q[2])};
  }
  return {};
}

void ForwardKinematics(const Skeleton& skeleton,
                       const ConstVectorView& positions,
                       const RigidTransform& world_from_skeleton,
                       WorldTransforms& world_from_joints) {
  world_from_joints.resize(skeleton.joint_count());
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const int parent = skeleton.span(i).parent;
    const RigidTransform& world_from_parent =
        parent < 0 ? world_from_skeleton : world_from_joints[parent];
    world_from_joints[i] = world_from_parent *
                           skeleton.joint(i).parent_from_joint *
                           JointMotion(skeleton, i, positions);
  }
}

}  // namespace gelenk
