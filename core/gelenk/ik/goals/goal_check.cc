#include "gelenk/ik/goals/goal_check.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {

void CheckRotation(absl::string_view field, Eigen::Quaterniond& rotation,
                   Violations& violations) {
  if (NormalizeNearUnit(rotation.coeffs().data())) return;
  violations.Add(
      field,
      absl::StrFormat("want a unit quaternion, got (%g, %g, %g, %g)",
                      rotation.x(), rotation.y(), rotation.z(), rotation.w()));
}

void CheckDirection(absl::string_view field, Eigen::Vector3d& direction,
                    Violations& violations) {
  const double length = direction.stableNorm();
  if (!(length >= kLeastDirection && std::isfinite(length))) {
    violations.Add(field,
                   absl::StrCat("want a direction, got ", Text(direction)));
    return;
  }
  if (std::abs(length - 1) > kUnitExact) direction /= length;
}

void CheckEffector(const Skeleton& skeleton, absl::string_view field,
                   absl::string_view id, Violations& violations) {
  if (skeleton.FindEffector(id)) return;
  violations.Add(field,
                 absl::StrCat("no end effector or joint ", QuotedId(id)));
}

}  // namespace gelenk
