// Where the mass of a skeleton is, and how it moves when the joints do.
//
// By Joint.link_mass_kg at Joint.link_center_of_mass; where no joint has a
// mass, all have the same. World frame, m. Cost: linear in the joints. Keeps
// its working memory, so that later calls on skeletons as large allocate
// nothing. Not thread-safe.
#ifndef GELENK_KINEMATICS_CENTER_OF_MASS_H_
#define GELENK_KINEMATICS_CENTER_OF_MASS_H_

#include <Eigen/Core>
#include <vector>

#include "gelenk/kinematics/forward_kinematics.h"

namespace gelenk {

class CenterOfMass {
 public:
  // `world_from_joints` is ForwardKinematics; returns the centre.
  Eigen::Vector3d Compute(const Skeleton& skeleton,
                          const WorldTransforms& world_from_joints);

  using JacobianView = Eigen::Ref<
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

  // After Compute at the same pose: the velocity of the centre, m/s, world
  // axes, by JointType's velocities. `jacobian` (3 x velocity_count) is
  // overwritten.
  void ComputeJacobian(const Skeleton& skeleton,
                       const ConstVectorView& positions,
                       const WorldTransforms& world_from_joints,
                       JacobianView jacobian) const;

 private:
  // Of each joint's link and all below it.
  std::vector<double> mass_;
  std::vector<Eigen::Vector3d> moment_;  // mass times place
};

}  // namespace gelenk

#endif  // GELENK_KINEMATICS_CENTER_OF_MASS_H_
