// Where is the second joint of an arm whose shoulder is turned by a quarter?
#include <cmath>
#include <cstdio>

#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/skeleton/skeleton_builder.h"

int main() {
  gelenk::Joint shoulder;
  shoulder.id = "shoulder";
  shoulder.type = gelenk::JointType::kRevolute;
  shoulder.axis = Eigen::Vector3d::UnitZ();
  gelenk::Joint elbow = shoulder;
  elbow.id = "elbow";
  elbow.parent_id = "shoulder";
  elbow.parent_from_joint.translation = Eigen::Vector3d(0.3, 0, 0);
  const auto arm =
      gelenk::SkeletonBuilder().AddJoint(shoulder).AddJoint(elbow).Build();
  if (!arm.ok()) return 1;

  const Eigen::Vector2d positions(std::acos(-1.0) / 2, 0);
  gelenk::WorldTransforms world_from_joints;
  gelenk::ForwardKinematics(**arm, positions, world_from_joints);
  const Eigen::Vector3d world_elbow = world_from_joints[1].translation;
  std::printf("elbow at %.3f %.3f %.3f\n", world_elbow.x(), world_elbow.y(),
              world_elbow.z());
  return (world_elbow - Eigen::Vector3d(0, 0.3, 0)).norm() < 1e-12 ? 0 : 1;
}
