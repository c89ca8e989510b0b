#include "gelenk/retarget/side_check.h"

#include <algorithm>

#include "gelenk/kinematics/forward_kinematics.h"

namespace gelenk {
namespace {

constexpr int kMaxSampledFrames = 100;
// Mean cosine beyond which a side is clear.
constexpr double kClear = 0.2;

}  // namespace

SwappedSides CheckSides(const Skeleton& skeleton, const JointMap& map,
                        const ClipView& clip) {
  SwappedSides swapped;
  if (!map.HasLegs() || !map.Has(BodyRole::kLeftToe) ||
      !map.Has(BodyRole::kRightToe)) {
    return swapped;
  }
  WorldTransforms world_from_joints;
  const auto at = [&](BodyRole role) -> const Eigen::Vector3d& {
    return world_from_joints[map.joint(role)].translation;
  };
  const Eigen::Vector3d& up = skeleton.up();
  double legs = 0;
  double arms = 0;
  int count = 0;
  const int step = std::max(1, clip.frame_count() / kMaxSampledFrames);
  for (int frame = clip.first_frame; frame < clip.frame_count();
       frame += step) {
    ForwardKinematics(skeleton, clip.positions.col(frame), world_from_joints);
    Eigen::Vector3d forward = Eigen::Vector3d::Zero();
    for (const LegRoles& leg : kLegRoles) {
      const Eigen::Vector3d foot = at(leg.toe) - at(leg.foot);
      forward += foot - foot.dot(up) * up;
    }
    const Eigen::Vector3d left = up.cross(forward).stableNormalized();
    legs += left.dot((at(BodyRole::kLeftThigh) - at(BodyRole::kRightThigh))
                         .stableNormalized());
    if (map.HasArm(kLeft) && map.HasArm(kRight)) {
      arms +=
          left.dot((at(BodyRole::kLeftUpperArm) - at(BodyRole::kRightUpperArm))
                       .stableNormalized());
    }
    ++count;
  }
  swapped.legs = legs < -kClear * count;
  swapped.arms = arms < -kClear * count;
  return swapped;
}

}  // namespace gelenk
