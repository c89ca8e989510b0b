// Poses and joint frames between the contract and the core.
#ifndef GELENK_CONVERT_POSE_H_
#define GELENK_CONVERT_POSE_H_

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/v1/skeleton.pb.h"

namespace gelenk::convert {

// INVALID_ARGUMENT as CheckPositions.
absl::StatusOr<Eigen::VectorXd> FromProto(const Skeleton& skeleton,
                                          const v1::Pose& proto);

// Unchecked. Allocates nothing once `positions` has held a pose of that size.
void CopyNumbers(const v1::Pose& proto, Eigen::VectorXd& positions);

// Allocates nothing once `proto` has held a pose of that size.
void ToProto(const ConstVectorView& positions, v1::Pose* proto);

void ToProto(const WorldTransforms& world_from_joints, v1::JointFrames* proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_POSE_H_
