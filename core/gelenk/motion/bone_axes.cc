#include "gelenk/motion/bone_axes.h"

namespace gelenk {
namespace {

// Shorter offsets are joints in one place: they have no direction.
constexpr double kShortestBoneM = 1e-6;

// Directions that are not told yet are zero.
void PointAt(const Eigen::Vector3d& offset, Eigen::Vector3d& axis) {
  if (axis.isZero() && offset.norm() > kShortestBoneM) {
    axis = offset.normalized();
  }
}

}  // namespace

std::vector<Eigen::Vector3d> BoneAxes(const Skeleton& skeleton) {
  std::vector<Eigen::Vector3d> axes(skeleton.joint_count(),
                                    Eigen::Vector3d::Zero());
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const int parent = skeleton.span(i).parent;
    if (parent < 0) continue;
    PointAt(skeleton.joint(i).parent_from_joint.translation, axes[parent]);
  }
  for (const EndEffector& effector : skeleton.end_effectors()) {
    PointAt(effector.joint_from_end_effector.translation,
            axes[skeleton.FindJoint(effector.joint_id)]);
  }
  for (Eigen::Vector3d& axis : axes) {
    PointAt(Eigen::Vector3d::UnitY(), axis);
  }
  return axes;
}

}  // namespace gelenk
