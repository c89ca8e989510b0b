#include "tests/testing/robot_of_hinges.h"

#include "gelenk/retarget/humanoid.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::testing {

std::shared_ptr<const Skeleton> RobotOfHinges() {
  const auto body = MakeHumanoid();
  SkeletonBuilder builder;
  for (int i = 0; i < body->joint_count(); ++i) {
    Joint ball = body->joint(i);
    if (i == 0) {
      ball.type = JointType::kFixed;
      ball.parent_from_joint.translation.y() = body->rest_positions()[1];
      builder.AddJoint(ball);
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      Joint hinge;
      const char* suffix[] = {"_x", "_z", ""};
      const Eigen::Vector3d axes[] = {Eigen::Vector3d::UnitX(),
                                      Eigen::Vector3d::UnitZ(),
                                      Eigen::Vector3d::UnitY()};
      hinge.id = ball.id + suffix[axis];
      hinge.parent_id = axis == 0 ? ball.parent_id : ball.id + suffix[axis - 1];
      hinge.type = JointType::kRevolute;
      hinge.axis = axes[axis];
      hinge.limits.lower = {-2.8};
      hinge.limits.upper = {2.8};
      if (axis == 0) hinge.parent_from_joint = ball.parent_from_joint;
      builder.AddJoint(hinge);
    }
  }
  for (const EndEffector& end : body->end_effectors()) {
    builder.AddEndEffector(end);
  }
  return *builder.Build();
}

}  // namespace gelenk::testing
