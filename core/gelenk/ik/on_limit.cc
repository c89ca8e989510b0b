#include "gelenk/ik/on_limit.h"

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

bool IsOnRotationLimit(const Joint& joint, const Eigen::Quaterniond& rotation) {
  // Without the numbers' limits: nothing is allocated.
  JointLimits narrowed;
  narrowed.swing_cone_rad = joint.limits.swing_cone_rad;
  narrowed.twist_lower_rad = joint.limits.twist_lower_rad;
  narrowed.twist_upper_rad = joint.limits.twist_upper_rad;
  if (narrowed.swing_cone_rad) *narrowed.swing_cone_rad -= kOnBound;
  if (narrowed.twist_lower_rad) *narrowed.twist_lower_rad += kOnBound;
  if (narrowed.twist_upper_rad) *narrowed.twist_upper_rad -= kOnBound;
  return RotationLimitExcess(narrowed, joint.axis, rotation) > 0;
}

}  // namespace

bool IsOnLimit(const Skeleton& skeleton, int joint,
               const ConstVectorView& positions) {
  const PositionBounds& bounds = skeleton.position_bounds();
  const int mimicked = skeleton.span(joint).mimicked;
  const int owner = mimicked < 0 ? joint : mimicked;
  const JointType type = skeleton.joint(owner).type;
  const int begin = skeleton.span(owner).position_offset;
  const int end = begin + PositionCount(type);
  for (int q = begin; q < end; ++q) {
    if (positions[q] <= bounds.lower[q] + kOnBound ||
        positions[q] >= bounds.upper[q] - kOnBound) {
      return true;
    }
  }
  const bool turns = type == JointType::kSpherical || type == JointType::kFree;
  if (!turns || !skeleton.joint(owner).limits.HasRotationLimits()) return false;
  return IsOnRotationLimit(skeleton.joint(owner),
                           QuaternionXyzw(positions.data() + end - 4));
}

}  // namespace gelenk
