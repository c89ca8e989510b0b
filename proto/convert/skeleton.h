// Skeletons between the contract and the core.
#ifndef GELENK_CONVERT_SKELETON_H_
#define GELENK_CONVERT_SKELETON_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "gelenk/v1/skeleton.pb.h"

namespace gelenk::convert {

// INVALID_ARGUMENT listing every violation, with the paths of the message.
absl::StatusOr<std::shared_ptr<const Skeleton>> FromProto(
    const v1::Skeleton& proto, const SkeletonBounds& bounds = {});

// Fills everything but name, display name, warnings and create time.
void ToProto(const Skeleton& skeleton, v1::Skeleton* proto);

// A skeleton file: proto3 JSON of gelenk.v1.Skeleton. Unknown fields are
// refused.
absl::StatusOr<v1::Skeleton> SkeletonFromJson(absl::string_view json);
std::string SkeletonToJson(const v1::Skeleton& proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_SKELETON_H_
