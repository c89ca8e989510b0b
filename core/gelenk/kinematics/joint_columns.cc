#include "gelenk/kinematics/joint_columns.h"

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

// The axes of a joint that moves along or about more than one, as the columns
// of `world_axes`.
void ListAxes(const Eigen::Matrix3d& world_axes, int first, bool turns,
              JointColumn* columns) {
  for (int k = 0; k < 3; ++k) {
    columns[k] = {first + k, turns, world_axes.col(k)};
  }
}

}  // namespace

int ListJointColumns(const Skeleton& skeleton, const ConstVectorView& positions,
                     const WorldTransforms& world_from_joints, int index,
                     JointColumns& columns) {
  const Joint& joint = skeleton.joint(index);
  if (joint.type == JointType::kFixed) return 0;
  const JointSpan& span = skeleton.span(index);
  const int owner = span.mimicked < 0 ? index : span.mimicked;
  const int v = skeleton.span(owner).velocity_offset;
  const double scale = joint.mimic ? joint.mimic->multiplier : 1;
  const Eigen::Quaterniond& world_from_joint =
      world_from_joints[index].rotation;
  // The rest frame follows from the joint's frame and its motion.
  const auto world_from_rest = [&] {
    return world_from_joint *
           JointMotion(skeleton, index, positions).rotation.conjugate();
  };
  switch (joint.type) {
    case JointType::kFixed:
      return 0;
    case JointType::kRevolute:
    case JointType::kPrismatic:
      // Its own motion leaves its axis where it is.
      columns[0] = {v, joint.type == JointType::kRevolute,
                    world_from_joint * (scale * joint.axis)};
      return 1;
    case JointType::kSpherical:
      ListAxes(world_from_joint.toRotationMatrix(), v, true, columns.data());
      return 3;
    case JointType::kPlanar:
      ListAxes(world_from_rest() * PlanarBasis(joint.axis), v, false,
               columns.data());
      columns[2].turns = true;
      return 3;
    case JointType::kFree:
      ListAxes(world_from_rest().toRotationMatrix(), v, false, columns.data());
      ListAxes(world_from_joint.toRotationMatrix(), v + 3, true,
               columns.data() + 3);
      return 6;
  }
  return 0;
}

}  // namespace gelenk
