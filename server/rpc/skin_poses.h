// Poses of a skin's skeleton as requests list them.
#ifndef GELENK_SERVER_RPC_SKIN_POSES_H_
#define GELENK_SERVER_RPC_SKIN_POSES_H_

#include <google/protobuf/repeated_ptr_field.h>

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/v1/skin_service.pb.h"

namespace gelenk::server {

struct PosedActor {
  Eigen::VectorXd positions;
  RigidTransform world_from_skeleton;
};

// INVALID_ARGUMENT below "poses" for more than `most`, and for each that is
// malformed.
absl::StatusOr<std::vector<PosedActor>> ReadPoses(
    const Skeleton& skeleton,
    const google::protobuf::RepeatedPtrField<v1::SkinPose>& poses, int most);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SKIN_POSES_H_
