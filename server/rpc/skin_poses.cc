#include "server/rpc/skin_poses.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "convert/geometry.h"
#include "convert/pose.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk::server {

absl::StatusOr<std::vector<PosedActor>> ReadPoses(
    const Skeleton& skeleton,
    const google::protobuf::RepeatedPtrField<v1::SkinPose>& poses, int most) {
  Violations violations;
  if (poses.size() > most) {
    violations.Add("poses",
                   absl::StrCat("want at most ", most, ", got ", poses.size()));
    return violations.ToStatus();
  }
  std::vector<PosedActor> actors(poses.size());
  for (int i = 0; i < poses.size(); ++i) {
    const std::string field = absl::StrCat("poses[", i, "]");
    PosedActor& actor = actors[i];
    actor.world_from_skeleton =
        convert::FromProto(poses[i].world_from_skeleton());
    CheckAndNormalize(field + ".world_from_skeleton", actor.world_from_skeleton,
                      violations);
    absl::StatusOr<Eigen::VectorXd> positions =
        convert::FromProto(skeleton, poses[i].pose());
    violations.AddStatus(field + ".pose", positions.status());
    if (positions.ok()) actor.positions = *std::move(positions);
  }
  if (!violations.empty()) return violations.ToStatus();
  return actors;
}

}  // namespace gelenk::server
