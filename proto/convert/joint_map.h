// Who plays which role of a body, between the contract and the core.
#ifndef GELENK_CONVERT_JOINT_MAP_H_
#define GELENK_CONVERT_JOINT_MAP_H_

#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "gelenk/retarget/joint_map.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/v1/joint_map.pb.h"

namespace gelenk::convert {

enum class MapSide { kSource, kTarget };

// What `proto` says of one side, for ProposeJointMap; `skeleton` is that
// side's. INVALID_ARGUMENT naming pairs without a role, roles that come twice,
// joints that the skeleton does not have or that get two roles.
absl::StatusOr<std::vector<JointMapOverride>> FromProto(
    const v1::JointMap& proto, MapSide side, const Skeleton& skeleton);

// What is told of both sides, for a request. Roles are known ones, each at most
// once on a side.
v1::JointMap ToProto(absl::Span<const JointMapOverride> source,
                     absl::Span<const JointMapOverride> target);

// A map with the skeleton that it is of.
struct MappedSkeleton {
  const JointMap& map;
  const Skeleton& skeleton;
};

// Replaces what `proto` holds.
void ToProto(const MappedSkeleton& source, const MappedSkeleton& target,
             v1::JointMap* proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_JOINT_MAP_H_
