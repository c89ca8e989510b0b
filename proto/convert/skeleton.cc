#include "convert/skeleton.h"

#include <google/protobuf/util/json_util.h>

#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "convert/geometry.h"
#include "convert/pose.h"
#include "gelenk/base/violations.h"

namespace gelenk::convert {
namespace {

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

std::vector<double> Numbers(
    const google::protobuf::RepeatedField<double>& proto) {
  return {proto.begin(), proto.end()};
}

void CopyNumbers(const std::vector<double>& numbers,
                 google::protobuf::RepeatedField<double>* proto) {
  proto->Assign(numbers.begin(), numbers.end());
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

Joint FromProto(const v1::Joint& proto, JointType type) {
  Joint joint;
  joint.id = proto.joint_id();
  joint.parent_id = proto.parent_joint_id();
  joint.type = type;
  joint.parent_from_joint = convert::FromProto(proto.parent_from_joint());
  if (proto.has_axis()) {
    joint.axis = convert::FromProto(proto.axis());
  } else if (NeedsAxis(type)) {
    joint.axis.setZero();  // required: refused by the builder
  }
  joint.limits = FromProto(proto.limits());
  if (proto.has_mimic()) {
    joint.mimic =
        Mimic{proto.mimic().joint_id(),
              proto.mimic().has_multiplier() ? proto.mimic().multiplier() : 1.0,
              proto.mimic().offset()};
  }
  joint.stiffness = Numbers(proto.stiffness());
  joint.link_length_m = proto.link_length_m();
  if (proto.has_link_direction()) {
    joint.link_direction = convert::FromProto(proto.link_direction());
  }
  joint.link_mass_kg = proto.link_mass_kg();
  joint.link_center_of_mass = convert::FromProto(proto.link_center_of_mass());
  return joint;
}

void ToProto(const Joint& joint, v1::Joint* proto) {
  proto->set_joint_id(joint.id);
  proto->set_parent_joint_id(joint.parent_id);
  proto->set_type(ToProto(joint.type));
  convert::ToProto(joint.parent_from_joint, proto->mutable_parent_from_joint());
  convert::ToProto(joint.axis, proto->mutable_axis());
  ToProto(joint.limits, proto->mutable_limits());
  if (joint.mimic) {
    proto->mutable_mimic()->set_joint_id(joint.mimic->joint_id);
    proto->mutable_mimic()->set_multiplier(joint.mimic->multiplier);
    proto->mutable_mimic()->set_offset(joint.mimic->offset);
  }
  CopyNumbers(joint.stiffness, proto->mutable_stiffness());
  proto->set_link_length_m(joint.link_length_m);
  convert::ToProto(joint.link_direction, proto->mutable_link_direction());
  proto->set_link_mass_kg(joint.link_mass_kg);
  convert::ToProto(joint.link_center_of_mass,
                   proto->mutable_link_center_of_mass());
}

}  // namespace

absl::StatusOr<std::shared_ptr<const Skeleton>> FromProto(
    const v1::Skeleton& proto, const SkeletonBounds& bounds) {
  Violations violations;
  SkeletonBuilder builder;
  builder.SetBounds(bounds);
  for (int i = 0; i < proto.joints_size(); ++i) {
    const std::optional<JointType> type = FromProto(proto.joints(i).type());
    if (!type) {
      violations.Add(absl::StrCat("joints[", i, "].type"),
                     absl::StrCat("no such joint type: ",
                                  static_cast<int>(proto.joints(i).type())));
    }
    builder.AddJoint(
        FromProto(proto.joints(i), type.value_or(JointType::kFixed)));
  }
  for (const v1::EndEffector& effector : proto.end_effectors()) {
    builder.AddEndEffector(
        {effector.end_effector_id(), effector.joint_id(),
         convert::FromProto(effector.joint_from_end_effector())});
  }
  builder.SetPlanar(proto.dimension() == v1::DIMENSION_PLANAR);
  if (proto.has_up()) builder.SetUp(convert::FromProto(proto.up()));
  if (proto.has_rest_pose()) {
    builder.SetRestPositions(
        Eigen::Map<const Eigen::VectorXd>(proto.rest_pose().positions().data(),
                                          proto.rest_pose().positions_size()));
  }
  absl::StatusOr<std::shared_ptr<const Skeleton>> skeleton = builder.Build();
  violations.AddStatus("", skeleton.status());
  if (!violations.empty()) return violations.ToStatus();
  return skeleton;
}

void ToProto(const Skeleton& skeleton, v1::Skeleton* proto) {
  proto->clear_joints();
  proto->clear_end_effectors();
  proto->clear_position_offsets();
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    ToProto(skeleton.joint(i), proto->add_joints());
    proto->add_position_offsets(skeleton.span(i).position_offset);
  }
  for (const EndEffector& effector : skeleton.end_effectors()) {
    v1::EndEffector* out = proto->add_end_effectors();
    out->set_end_effector_id(effector.id);
    out->set_joint_id(effector.joint_id);
    convert::ToProto(effector.joint_from_end_effector,
                     out->mutable_joint_from_end_effector());
  }
  convert::ToProto(skeleton.up(), proto->mutable_up());
  convert::ToProto(skeleton.rest_positions(), proto->mutable_rest_pose());
  proto->set_position_count(skeleton.position_count());
  proto->set_velocity_count(skeleton.velocity_count());
}

absl::StatusOr<v1::Skeleton> SkeletonFromJson(absl::string_view json) {
  v1::Skeleton proto;
  const auto status =
      google::protobuf::util::JsonStringToMessage(std::string(json), &proto);
  if (status.ok()) return proto;
  return absl::InvalidArgumentError(absl::StrCat(
      "no skeleton in proto3 JSON: ", std::string(status.message())));
}

std::string SkeletonToJson(const v1::Skeleton& proto) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  std::string json;
  // Fails only for Any and malformed times, which a skeleton does not have.
  google::protobuf::util::MessageToJsonString(proto, &json, options).ok();
  return json;
}

}  // namespace gelenk::convert
