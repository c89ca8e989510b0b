#include "convert/goal_kind.h"

#include "convert/geometry.h"

namespace gelenk::convert {
namespace {

// Of the goals that hold both a point and an orientation.
template <class Proto, class KindOfGoal>
void ScaleFromProto(const Proto& proto, KindOfGoal& goal) {
  if (proto.has_rotation_scale_m_per_rad()) {
    goal.rotation_scale_m_per_rad = proto.rotation_scale_m_per_rad();
  }
}

AxisMask MaskFromProto(bool has_mask, const v1::AxisMask& proto) {
  if (!has_mask) return {};
  return {proto.x(), proto.y(), proto.z()};
}

// `make` gives the message, only where there is something to say.
template <class Make>
void MaskToProto(const AxisMask& mask, Make make) {
  if (mask.count() == 3) return;
  v1::AxisMask* proto = make();
  proto->set_x(mask.x);
  proto->set_y(mask.y);
  proto->set_z(mask.z);
}

PositionGoal FromProto(const v1::PositionGoal& proto) {
  return {proto.end_effector_id(), convert::FromProto(proto.world_position()),
          MaskFromProto(proto.has_axes(), proto.axes())};
}

RotationGoal FromProto(const v1::RotationGoal& proto) {
  RotationGoal goal;
  goal.end_effector_id = proto.end_effector_id();
  if (proto.has_world_rotation()) {
    goal.world_rotation = convert::FromProto(proto.world_rotation());
  }
  goal.axes = MaskFromProto(proto.has_axes(), proto.axes());
  return goal;
}

PoseGoal FromProto(const v1::PoseGoal& proto) {
  PoseGoal goal;
  goal.end_effector_id = proto.end_effector_id();
  goal.world_pose = convert::FromProto(proto.world_pose());
  ScaleFromProto(proto, goal);
  goal.axes = MaskFromProto(proto.has_axes(), proto.axes());
  goal.rotation_axes =
      MaskFromProto(proto.has_rotation_axes(), proto.rotation_axes());
  return goal;
}

AimGoal FromProto(const v1::AimGoal& proto) {
  AimGoal goal;
  goal.end_effector_id = proto.end_effector_id();
  if (proto.has_axis()) goal.axis = convert::FromProto(proto.axis());
  goal.world_point = convert::FromProto(proto.world_point());
  return goal;
}

PoleGoal FromProto(const v1::PoleGoal& proto) {
  return {proto.root_joint_id(), proto.mid_joint_id(), proto.tip_joint_id(),
          convert::FromProto(proto.world_point())};
}

RelativeGoal FromProto(const v1::RelativeGoal& proto) {
  RelativeGoal goal;
  goal.reference_end_effector_id = proto.reference_end_effector_id();
  goal.end_effector_id = proto.end_effector_id();
  goal.reference_from_end_effector =
      convert::FromProto(proto.reference_from_end_effector());
  ScaleFromProto(proto, goal);
  return goal;
}

CenterOfMassGoal FromProto(const v1::CenterOfMassGoal& proto) {
  return {convert::FromProto(proto.world_position()),
          MaskFromProto(proto.has_axes(), proto.axes())};
}

PostureGoal FromProto(const v1::PostureGoal& proto) {
  PostureGoal goal;
  const auto& positions = proto.pose().positions();
  goal.positions =
      Eigen::Map<const Eigen::VectorXd>(positions.data(), positions.size());
  goal.joint_weights.assign(proto.joint_weights().begin(),
                            proto.joint_weights().end());
  return goal;
}

HalfSpaceGoal FromProto(const v1::HalfSpaceGoal& proto) {
  HalfSpaceGoal goal;
  goal.end_effector_id = proto.end_effector_id();
  goal.is_ground = !proto.has_plane();
  if (goal.is_ground) return goal;
  goal.world_normal = convert::FromProto(proto.plane().normal());
  goal.offset_m = proto.plane().offset_m();
  return goal;
}

PlantGoal FromProto(const v1::PlantGoal& proto) {
  PlantGoal goal;
  goal.end_effector_id = proto.end_effector_id();
  ScaleFromProto(proto, goal);
  return goal;
}

void ToProto(const PositionGoal& goal, v1::Goal* proto) {
  v1::PositionGoal* out = proto->mutable_position();
  out->set_end_effector_id(goal.end_effector_id);
  convert::ToProto(goal.world_position, out->mutable_world_position());
  MaskToProto(goal.axes, [out] { return out->mutable_axes(); });
}

void ToProto(const RotationGoal& goal, v1::Goal* proto) {
  v1::RotationGoal* out = proto->mutable_rotation();
  out->set_end_effector_id(goal.end_effector_id);
  convert::ToProto(goal.world_rotation, out->mutable_world_rotation());
  MaskToProto(goal.axes, [out] { return out->mutable_axes(); });
}

void ToProto(const PoseGoal& goal, v1::Goal* proto) {
  v1::PoseGoal* out = proto->mutable_pose();
  out->set_end_effector_id(goal.end_effector_id);
  convert::ToProto(goal.world_pose, out->mutable_world_pose());
  out->set_rotation_scale_m_per_rad(goal.rotation_scale_m_per_rad);
  MaskToProto(goal.axes, [out] { return out->mutable_axes(); });
  MaskToProto(goal.rotation_axes,
              [out] { return out->mutable_rotation_axes(); });
}

void ToProto(const AimGoal& goal, v1::Goal* proto) {
  v1::AimGoal* out = proto->mutable_aim();
  out->set_end_effector_id(goal.end_effector_id);
  convert::ToProto(goal.axis, out->mutable_axis());
  convert::ToProto(goal.world_point, out->mutable_world_point());
}

void ToProto(const PoleGoal& goal, v1::Goal* proto) {
  v1::PoleGoal* out = proto->mutable_pole();
  out->set_root_joint_id(goal.root_joint_id);
  out->set_mid_joint_id(goal.mid_joint_id);
  out->set_tip_joint_id(goal.tip_joint_id);
  convert::ToProto(goal.world_point, out->mutable_world_point());
}

void ToProto(const RelativeGoal& goal, v1::Goal* proto) {
  v1::RelativeGoal* out = proto->mutable_relative();
  out->set_reference_end_effector_id(goal.reference_end_effector_id);
  out->set_end_effector_id(goal.end_effector_id);
  convert::ToProto(goal.reference_from_end_effector,
                   out->mutable_reference_from_end_effector());
  out->set_rotation_scale_m_per_rad(goal.rotation_scale_m_per_rad);
}

void ToProto(const CenterOfMassGoal& goal, v1::Goal* proto) {
  v1::CenterOfMassGoal* out = proto->mutable_center_of_mass();
  convert::ToProto(goal.world_position, out->mutable_world_position());
  MaskToProto(goal.axes, [out] { return out->mutable_axes(); });
}

void ToProto(const PostureGoal& goal, v1::Goal* proto) {
  v1::PostureGoal* out = proto->mutable_posture();
  out->mutable_pose()->mutable_positions()->Assign(goal.positions.begin(),
                                                   goal.positions.end());
  out->mutable_joint_weights()->Assign(goal.joint_weights.begin(),
                                       goal.joint_weights.end());
}

void ToProto(const HalfSpaceGoal& goal, v1::Goal* proto) {
  v1::HalfSpaceGoal* out = proto->mutable_half_space();
  out->set_end_effector_id(goal.end_effector_id);
  if (goal.is_ground) return;
  convert::ToProto(goal.world_normal, out->mutable_plane()->mutable_normal());
  out->mutable_plane()->set_offset_m(goal.offset_m);
}

void ToProto(const PlantGoal& goal, v1::Goal* proto) {
  v1::PlantGoal* out = proto->mutable_plant();
  out->set_end_effector_id(goal.end_effector_id);
  out->set_rotation_scale_m_per_rad(goal.rotation_scale_m_per_rad);
}

}  // namespace

std::optional<GoalKind> KindFromProto(const v1::Goal& proto) {
  switch (proto.kind_case()) {
    case v1::Goal::kPosition:
      return FromProto(proto.position());
    case v1::Goal::kRotation:
      return FromProto(proto.rotation());
    case v1::Goal::kPose:
      return FromProto(proto.pose());
    case v1::Goal::kAim:
      return FromProto(proto.aim());
    case v1::Goal::kPole:
      return FromProto(proto.pole());
    case v1::Goal::kRelative:
      return FromProto(proto.relative());
    case v1::Goal::kCenterOfMass:
      return FromProto(proto.center_of_mass());
    case v1::Goal::kPosture:
      return FromProto(proto.posture());
    case v1::Goal::kHalfSpace:
      return FromProto(proto.half_space());
    case v1::Goal::kPlant:
      return FromProto(proto.plant());
    case v1::Goal::KIND_NOT_SET:
      break;
  }
  return std::nullopt;
}

void KindToProto(const GoalKind& kind, v1::Goal* proto) {
  std::visit([proto](const auto& goal) { ToProto(goal, proto); }, kind);
}

}  // namespace gelenk::convert
