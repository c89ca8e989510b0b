#include "gelenk/kinematics/jacobian.h"

#include "gelenk/kinematics/joint_columns.h"

namespace gelenk {

void ComputeJacobian(const Skeleton& skeleton, const ConstVectorView& positions,
                     const WorldTransforms& world_from_joints,
                     const EffectorFrame& effector,
                     Eigen::Matrix<double, 6, Eigen::Dynamic>& jacobian) {
  jacobian.setZero(6, skeleton.velocity_count());
  const Eigen::Vector3d world_tip = world_from_joints[effector.joint] *
                                    effector.joint_from_effector.translation;
  JointColumns columns;
  for (int i = effector.joint; i >= 0; i = skeleton.span(i).parent) {
    const int count =
        ListJointColumns(skeleton, positions, world_from_joints, i, columns);
    const Eigen::Vector3d arm = world_tip - world_from_joints[i].translation;
    for (int k = 0; k < count; ++k) {
      jacobian.col(columns[k].column) += columns[k].Twist(arm);
    }
  }
}

}  // namespace gelenk
