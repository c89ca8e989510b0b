// Validates one joint or end effector on its own, without its neighbours.
#ifndef GELENK_SKELETON_JOINT_CHECK_H_
#define GELENK_SKELETON_JOINT_CHECK_H_

#include <string>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint.h"

namespace gelenk {

// `v` as "(x, y, z)", for messages.
std::string Text(const Eigen::Vector3d& v);

// `id` in quotes, escaped, cut where it is longer than an id can be.
std::string QuotedId(absl::string_view id);

// Ids are 1 to kMaxIdBytes bytes of text without control characters.
inline constexpr int kMaxIdBytes = 63;
void CheckId(absl::string_view field, absl::string_view id,
             Violations& violations);

// Checks `joint` and makes its axis, link direction and rotation exactly unit.
// `field` is its path ("joints[2]").
void CheckAndNormalize(absl::string_view field, Joint& joint,
                       Violations& violations);

// Checks that `transform` is finite and near unit, and normalises it.
void CheckAndNormalize(absl::string_view field, RigidTransform& transform,
                       Violations& violations);

}  // namespace gelenk

#endif  // GELENK_SKELETON_JOINT_CHECK_H_
