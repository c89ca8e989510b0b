#include "tests/benchmarks/ik/damped_least_squares.h"

#include <Eigen/Cholesky>

#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/kinematics/jacobian.h"

namespace gelenk::benchmarks {

void DampedLeastSquares::Solve(const Skeleton& skeleton,
                               const std::string& end_effector_id,
                               const Eigen::Vector3d& world_target,
                               VectorView positions) const {
  const EffectorFrame effector = *skeleton.FindEffector(end_effector_id);
  WorldTransforms frames;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;
  for (int i = 0; i < steps; ++i) {
    ForwardKinematics(skeleton, positions, frames);
    ComputeJacobian(skeleton, positions, frames, effector, jacobian);
    const Eigen::Vector3d error =
        world_target -
        (frames[effector.joint] * effector.joint_from_effector).translation;
    const Eigen::MatrixXd rows = jacobian.topRows<3>();
    const Eigen::Matrix3d damped =
        rows * rows.transpose() +
        damping * damping * Eigen::Matrix3d::Identity();
    const Eigen::VectorXd step = rows.transpose() * damped.ldlt().solve(error);
    Integrate(skeleton, positions, step, positions);
    ClampToLimits(skeleton, positions);
  }
}

}  // namespace gelenk::benchmarks
