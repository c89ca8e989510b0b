#include "client/cli/info/inspection.h"

namespace gelenk::cli {
namespace {

Json Numbers(const Eigen::Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Json BodyJson(const Skeleton& skeleton, const BodyParts& body) {
  Json json;
  json["evidence"] = std::string(EvidenceName(body.evidence));
  for (const NamedPart& part : PartsOf(body)) {
    json[part.name] =
        part.joint < 0 ? Json() : Json(skeleton.joint(part.joint).id);
  }
  return json;
}

Json JumpJson(const Inspection& inspection) {
  if (!inspection.first_frame_jump) return Json();
  const FirstFrameJump& jump = *inspection.first_frame_jump;
  return {{"joint", inspection.file->skeleton->joint(jump.joint).id},
          {"angle_rad", jump.angle_rad},
          {"typical_rad", jump.typical_rad}};
}

Json ClipJson(const Inspection& inspection) {
  if (!inspection.file->clip) return Json();
  const BvhClip& clip = *inspection.file->clip;
  const double frame_time_s = clip.document.frame_time_s;
  Json json;
  json["frames"] = clip.frame_count();
  json["frame_time_s"] = frame_time_s;
  json["fps"] = 1 / frame_time_s;
  json["duration_s"] = frame_time_s * clip.frame_count();
  json["unit_m"] = clip.import.unit_m;
  json["first_frame_jump"] = JumpJson(inspection);
  return json;
}

Json MimicJson(const Joint& joint) {
  if (!joint.mimic) return Json();
  return {{"joint", joint.mimic->joint_id},
          {"multiplier", joint.mimic->multiplier},
          {"offset", joint.mimic->offset}};
}

Json JointJson(const Inspection& inspection, int index) {
  const Joint& joint = inspection.file->skeleton->joint(index);
  Json json;
  json["id"] = joint.id;
  json["parent"] = joint.parent_id.empty() ? Json() : Json(joint.parent_id);
  json["type"] = std::string(JointTypeName(joint.type));
  json["channels"] = inspection.channels[index];
  json["offset_m"] = Numbers(joint.parent_from_joint.translation);
  json["limited"] =
      !joint.limits.lower.empty() || joint.limits.HasRotationLimits();
  // Where a side has no limit its number is null.
  json["lower"] = joint.limits.lower;
  json["upper"] = joint.limits.upper;
  json["max_velocity"] = joint.limits.max_velocity;
  json["mimic"] = MimicJson(joint);
  return json;
}

}  // namespace

Json InspectionJson(const Inspection& inspection) {
  const SkeletonFile& file = *inspection.file;
  const Skeleton& skeleton = *file.skeleton;
  Json json;
  json["file"] = file.path;
  json["joint_count"] = skeleton.joint_count();
  json["position_count"] = skeleton.position_count();
  json["velocity_count"] = skeleton.velocity_count();
  json["up"] = Numbers(skeleton.up());
  json["height_m"] = inspection.height_m ? Json(*inspection.height_m) : Json();
  json["body"] = BodyJson(skeleton, inspection.body);
  json["clip"] = ClipJson(inspection);
  json["joints"] = Json::array();
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    json["joints"].push_back(JointJson(inspection, i));
  }
  json["end_effectors"] = Json::array();
  for (const EndEffector& effector : skeleton.end_effectors()) {
    json["end_effectors"].push_back(
        {{"id", effector.id},
         {"joint", effector.joint_id},
         {"offset_m", Numbers(effector.joint_from_end_effector.translation)}});
  }
  json["tips"] = inspection.tips;
  json["warnings"] = file.message.warnings();
  return json;
}

}  // namespace gelenk::cli
