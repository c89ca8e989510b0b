#include "gelenk/retarget/floating_base.h"

#include <utility>

#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {

absl::StatusOr<std::shared_ptr<const Skeleton>> WithFloatingBase(
    std::shared_ptr<const Skeleton> skeleton) {
  if (skeleton->joint_count() == 0 ||
      skeleton->joint(0).type != JointType::kFixed) {
    return skeleton;
  }
  SkeletonBuilder builder;
  for (int i = 0; i < skeleton->joint_count(); ++i) {
    Joint joint = skeleton->joint(i);
    if (i == 0) joint.type = JointType::kFree;
    builder.AddJoint(std::move(joint));
  }
  for (const EndEffector& end : skeleton->end_effectors()) {
    builder.AddEndEffector(end);
  }
  Eigen::VectorXd rest(7 + skeleton->position_count());
  rest << 0, 0, 0, 0, 0, 0, 1, skeleton->rest_positions();
  return builder.SetUp(skeleton->up())
      .SetRestPositions(std::move(rest))
      .Build();
}

}  // namespace gelenk
