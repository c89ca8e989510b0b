#include "tests/core/formats/bvh_oracle.h"

#include <algorithm>
#include <numbers>

namespace gelenk {

std::vector<Eigen::Affine3d> OracleWorldFromJoints(const BvhDocument& document,
                                                   int frame) {
  std::vector<Eigen::Affine3d> world_from_joints;
  int row = 0;
  for (const BvhJoint& joint : document.joints) {
    Eigen::Vector3d translation = joint.offset;
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    for (BvhChannel channel : joint.channels) {
      const double value = document.motion(row++, frame);
      const int axis = AxisOf(channel);
      if (IsPosition(channel)) {
        translation[axis] = value;
      } else {
        rotation *= Eigen::AngleAxisd(value * std::numbers::pi / 180,
                                      Eigen::Vector3d::Unit(axis))
                        .toRotationMatrix();
      }
    }
    const Eigen::Affine3d parent_from_joint =
        Eigen::Translation3d(translation) * rotation;
    world_from_joints.push_back(
        joint.parent < 0 ? parent_from_joint
                         : world_from_joints[joint.parent] * parent_from_joint);
  }
  return world_from_joints;
}

BvhDifference CompareMotion(const BvhDocument& a, const BvhDocument& b) {
  BvhDifference worst;
  for (int frame = 0; frame < a.frame_count(); ++frame) {
    const auto world_a = OracleWorldFromJoints(a, frame);
    const auto world_b = OracleWorldFromJoints(b, frame);
    for (size_t i = 0; i < world_a.size(); ++i) {
      const Eigen::Matrix4d difference =
          world_a[i].matrix() - world_b[i].matrix();
      worst.rotation =
          std::max(worst.rotation, difference.topLeftCorner<3, 3>().norm());
      worst.position =
          std::max(worst.position, difference.topRightCorner<3, 1>().norm());
    }
  }
  return worst;
}

}  // namespace gelenk
