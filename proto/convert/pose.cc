#include "convert/pose.h"

#include <algorithm>

namespace gelenk::convert {

absl::StatusOr<Eigen::VectorXd> FromProto(const Skeleton& skeleton,
                                          const v1::Pose& proto) {
  Eigen::VectorXd positions = Eigen::Map<const Eigen::VectorXd>(
      proto.positions().data(), proto.positions_size());
  if (absl::Status status = CheckPositions(skeleton, positions); !status.ok()) {
    return status;
  }
  return positions;
}

void CopyNumbers(const v1::Pose& proto, Eigen::VectorXd& positions) {
  positions = Eigen::Map<const Eigen::VectorXd>(proto.positions().data(),
                                                proto.positions_size());
}

void ToProto(const ConstVectorView& positions, v1::Pose* proto) {
  auto* out = proto->mutable_positions();
  out->Resize(static_cast<int>(positions.size()), 0);
  std::copy_n(positions.data(), positions.size(), out->mutable_data());
}

void ToProto(const WorldTransforms& world_from_joints, v1::JointFrames* proto) {
  proto->clear_world_translations();
  proto->clear_world_rotations();
  for (const RigidTransform& frame : world_from_joints) {
    for (int k = 0; k < 3; ++k) {
      proto->add_world_translations(static_cast<float>(frame.translation[k]));
    }
    for (int k = 0; k < 4; ++k) {  // Eigen stores x y z w
      proto->add_world_rotations(
          static_cast<float>(frame.rotation.coeffs()[k]));
    }
  }
}

}  // namespace gelenk::convert
