#include "convert/skeleton.h"

#include <google/protobuf/util/json_util.h>

#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "convert/chain.h"
#include "convert/geometry.h"
#include "convert/limits.h"
#include "convert/pose.h"
#include "gelenk/base/violations.h"

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
  joint.limits = convert::FromProto(proto.limits());
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
  proto->set_type(convert::ToProto(joint.type));
  convert::ToProto(joint.parent_from_joint, proto->mutable_parent_from_joint());
  convert::ToProto(joint.axis, proto->mutable_axis());
  convert::ToProto(joint.limits, proto->mutable_limits());
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

// Joints and end effectors, be they listed or in shorthand.
absl::StatusOr<SkeletonBuilder> JointsOf(const v1::Skeleton& proto,
                                         Violations& violations) {
  const bool is_listed =
      proto.joints_size() > 0 || proto.end_effectors_size() > 0;
  if (proto.shorthand_case() != v1::Skeleton::SHORTHAND_NOT_SET && is_listed) {
    violations.Add(proto.has_dh_table() ? "dh_table" : "planar_chain",
                   "want joints or a shorthand, got both");
    return violations.ToStatus();
  }
  if (proto.has_dh_table()) {
    absl::StatusOr<DhTable> table = convert::FromProto(proto.dh_table());
    absl::StatusOr<SkeletonBuilder> builder =
        table.ok() ? BuilderOf(*table) : table.status();
    violations.AddStatus("dh_table", builder.status());
    if (!builder.ok()) return violations.ToStatus();
    return builder;
  }
  if (proto.has_planar_chain()) {
    absl::StatusOr<PlanarChain> chain =
        convert::FromProto(proto.planar_chain());
    absl::StatusOr<SkeletonBuilder> builder =
        chain.ok() ? BuilderOf(*chain) : chain.status();
    violations.AddStatus("planar_chain", builder.status());
    if (!builder.ok()) return violations.ToStatus();
    return builder;
  }
  SkeletonBuilder builder;
  for (int i = 0; i < proto.joints_size(); ++i) {
    const std::optional<JointType> type =
        convert::FromProto(proto.joints(i).type());
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
  return builder;
}

}  // namespace

absl::StatusOr<std::shared_ptr<const Skeleton>> FromProto(
    const v1::Skeleton& proto, const SkeletonBounds& bounds) {
  Violations violations;
  absl::StatusOr<SkeletonBuilder> builder_or = JointsOf(proto, violations);
  if (!builder_or.ok()) return builder_or.status();
  SkeletonBuilder& builder = *builder_or;
  builder.SetBounds(bounds);
  if (!proto.has_planar_chain() ||
      proto.dimension() != v1::DIMENSION_UNSPECIFIED) {
    builder.SetPlanar(proto.dimension() == v1::DIMENSION_PLANAR);
  }
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
  // The joints take the shorthand's place, and what it implied.
  if (proto->has_planar_chain() &&
      proto->dimension() == v1::DIMENSION_UNSPECIFIED) {
    proto->set_dimension(v1::DIMENSION_PLANAR);
  }
  proto->clear_shorthand();
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
