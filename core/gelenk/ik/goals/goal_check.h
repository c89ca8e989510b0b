// What the goal kinds check in common. Fields are named below their kind.
//
// Errors: collected in Violations; nothing is changed but what is normalised.
#ifndef GELENK_IK_GOALS_GOAL_CHECK_H_
#define GELENK_IK_GOALS_GOAL_CHECK_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "absl/strings/string_view.h"
#include "gelenk/base/number_check.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// Shorter directions have none that means anything.
inline constexpr double kLeastDirection = 1e-9;

// Makes near-unit quaternions unit; see NormalizeNearUnit.
void CheckRotation(absl::string_view field, Eigen::Quaterniond& rotation,
                   Violations& violations);

// Any length but zero; normalised.
void CheckDirection(absl::string_view field, Eigen::Vector3d& direction,
                    Violations& violations);

// An end effector or a joint of that id must be there.
void CheckEffector(const Skeleton& skeleton, absl::string_view field,
                   absl::string_view id, Violations& violations);

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_GOAL_CHECK_H_
