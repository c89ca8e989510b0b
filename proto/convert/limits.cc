#include "convert/limits.h"

#include <vector>

namespace gelenk::convert {
namespace {

std::vector<double> Numbers(
    const google::protobuf::RepeatedField<double>& proto) {
  return {proto.begin(), proto.end()};
}

void CopyNumbers(const std::vector<double>& numbers,
                 google::protobuf::RepeatedField<double>* proto) {
  proto->Assign(numbers.begin(), numbers.end());
}

}  // namespace

std::optional<JointType> FromProto(v1::JointType type) {
  switch (type) {
    case v1::JOINT_TYPE_FIXED:
      return JointType::kFixed;
    case v1::JOINT_TYPE_REVOLUTE:
      return JointType::kRevolute;
    case v1::JOINT_TYPE_PRISMATIC:
      return JointType::kPrismatic;
    case v1::JOINT_TYPE_SPHERICAL:
      return JointType::kSpherical;
    case v1::JOINT_TYPE_PLANAR:
      return JointType::kPlanar;
    case v1::JOINT_TYPE_FREE:
      return JointType::kFree;
    default:
      return std::nullopt;
  }
}

v1::JointType ToProto(JointType type) {
  switch (type) {
    case JointType::kFixed:
      return v1::JOINT_TYPE_FIXED;
    case JointType::kRevolute:
      return v1::JOINT_TYPE_REVOLUTE;
    case JointType::kPrismatic:
      return v1::JOINT_TYPE_PRISMATIC;
    case JointType::kSpherical:
      return v1::JOINT_TYPE_SPHERICAL;
    case JointType::kPlanar:
      return v1::JOINT_TYPE_PLANAR;
    case JointType::kFree:
      return v1::JOINT_TYPE_FREE;
  }
  return v1::JOINT_TYPE_UNSPECIFIED;
}

JointLimits FromProto(const v1::JointLimits& proto) {
  JointLimits limits;
  limits.lower = Numbers(proto.lower());
  limits.upper = Numbers(proto.upper());
  if (proto.has_swing_cone_rad()) {
    limits.swing_cone_rad = proto.swing_cone_rad();
  }
  if (proto.has_twist_lower_rad()) {
    limits.twist_lower_rad = proto.twist_lower_rad();
  }
  if (proto.has_twist_upper_rad()) {
    limits.twist_upper_rad = proto.twist_upper_rad();
  }
  limits.max_velocity = Numbers(proto.max_velocity());
  limits.max_acceleration = Numbers(proto.max_acceleration());
  return limits;
}

void ToProto(const JointLimits& limits, v1::JointLimits* proto) {
  CopyNumbers(limits.lower, proto->mutable_lower());
  CopyNumbers(limits.upper, proto->mutable_upper());
  if (limits.swing_cone_rad) proto->set_swing_cone_rad(*limits.swing_cone_rad);
  if (limits.twist_lower_rad) {
    proto->set_twist_lower_rad(*limits.twist_lower_rad);
  }
  if (limits.twist_upper_rad) {
    proto->set_twist_upper_rad(*limits.twist_upper_rad);
  }
  CopyNumbers(limits.max_velocity, proto->mutable_max_velocity());
  CopyNumbers(limits.max_acceleration, proto->mutable_max_acceleration());
}

}  // namespace gelenk::convert
