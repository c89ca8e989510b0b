#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

int Skeleton::FindJoint(absl::string_view id) const {
  for (int i = 0; i < joint_count(); ++i) {
    if (joints_[i].id == id) return i;
  }
  return -1;
}

std::optional<EffectorFrame> Skeleton::FindEffector(
    absl::string_view id) const {
  for (const EndEffector& effector : end_effectors_) {
    if (effector.id == id) {
      return EffectorFrame{FindJoint(effector.joint_id),
                           effector.joint_from_end_effector};
    }
  }
  const int joint = FindJoint(id);
  if (joint < 0) return std::nullopt;
  return EffectorFrame{joint, RigidTransform()};
}

size_t Skeleton::ByteSize() const {
  size_t bytes = sizeof(*this) + 3 * position_count_ * sizeof(double);
  for (const Joint& joint : joints_) {
    const JointLimits& limits = joint.limits;
    bytes += sizeof(Joint) + sizeof(JointSpan) + joint.id.capacity() +
             joint.parent_id.capacity();
    bytes += sizeof(double) *
             (limits.lower.capacity() + limits.upper.capacity() +
              limits.max_velocity.capacity() +
              limits.max_acceleration.capacity() + joint.stiffness.capacity());
  }
  for (const EndEffector& effector : end_effectors_) {
    bytes += sizeof(EndEffector) + effector.id.capacity() +
             effector.joint_id.capacity();
  }
  return bytes;
}

}  // namespace gelenk
