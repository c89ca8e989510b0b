// Joint types and limits between the contract and the core.
#ifndef GELENK_CONVERT_LIMITS_H_
#define GELENK_CONVERT_LIMITS_H_

#include <optional>

#include "gelenk/skeleton/joint.h"
#include "gelenk/skeleton/joint_limits.h"
#include "gelenk/v1/joint.pb.h"

namespace gelenk::convert {

// None for a number that names no type.
std::optional<JointType> FromProto(v1::JointType type);
v1::JointType ToProto(JointType type);

// Unchecked; see geometry.h.
JointLimits FromProto(const v1::JointLimits& proto);
void ToProto(const JointLimits& limits, v1::JointLimits* proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_LIMITS_H_
