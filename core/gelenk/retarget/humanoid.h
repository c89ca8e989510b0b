// A body of our own, to retarget onto when there is no other.
#ifndef GELENK_RETARGET_HUMANOID_H_
#define GELENK_RETARGET_HUMANOID_H_

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// An adult of 1.75 m in a T-pose, up +Y, facing +Z, its soles at height 0: 22
// joints (free "pelvis", all others spherical with a swing cone and a range of
// twist, about those of an agile person), mass of the links, end effectors
// "left_heel", "left_toe_tip", "left_palm", their right ones, and "crown".
// Of another height all lengths are in proportion; `height_m` > 0.
inline constexpr double kHumanoidHeightM = 1.75;
std::shared_ptr<const Skeleton> MakeHumanoid(
    double height_m = kHumanoidHeightM);

// Skeletons that come with the library: "humanoid".
std::vector<absl::string_view> BundledSkeletonNames();
// Errors: NOT_FOUND naming those that there are.
absl::StatusOr<std::shared_ptr<const Skeleton>> BundledSkeleton(
    absl::string_view name);

}  // namespace gelenk

#endif  // GELENK_RETARGET_HUMANOID_H_
