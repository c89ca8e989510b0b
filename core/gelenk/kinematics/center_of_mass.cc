#include "gelenk/kinematics/center_of_mass.h"

#include "gelenk/kinematics/joint_columns.h"

namespace gelenk {
namespace {

bool HasMass(const Skeleton& skeleton) {
  for (const Joint& joint : skeleton.joints()) {
    if (joint.link_mass_kg > 0) return true;
  }
  return false;
}

}  // namespace

Eigen::Vector3d CenterOfMass::Compute(
    const Skeleton& skeleton, const WorldTransforms& world_from_joints) {
  const int count = skeleton.joint_count();
  mass_.resize(count);
  moment_.resize(count);
  const bool has_mass = HasMass(skeleton);
  for (int i = 0; i < count; ++i) {
    const Joint& joint = skeleton.joint(i);
    mass_[i] = has_mass ? joint.link_mass_kg : 1;
    moment_[i] = mass_[i] * (world_from_joints[i] * joint.link_center_of_mass);
  }
  // Children come after their parents.
  for (int i = count - 1; i > 0; --i) {
    const int parent = skeleton.span(i).parent;
    mass_[parent] += mass_[i];
    moment_[parent] += moment_[i];
  }
  return moment_[0] / mass_[0];
}

void CenterOfMass::ComputeJacobian(const Skeleton& skeleton,
                                   const ConstVectorView& positions,
                                   const WorldTransforms& world_from_joints,
                                   JacobianView jacobian) const {
  jacobian.setZero();
  JointColumns columns;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    if (mass_[i] <= 0) continue;
    const int count =
        ListJointColumns(skeleton, positions, world_from_joints, i, columns);
    const double share = mass_[i] / mass_[0];
    const Eigen::Vector3d arm =
        moment_[i] / mass_[i] - world_from_joints[i].translation;
    for (int k = 0; k < count; ++k) {
      jacobian.col(columns[k].column) +=
          share * columns[k].Twist(arm).head<3>();
    }
  }
}

}  // namespace gelenk
