#include "gelenk/motion/clip_skeleton.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

// What is other of a joint; empty for nothing.
std::string Difference(const Skeleton& skeleton, const Skeleton& wanted,
                       int index) {
  const Joint& joint = skeleton.joint(index);
  const Joint& other = wanted.joint(index);
  if (joint.id != other.id) {
    return absl::StrCat("want ", QuotedId(other.id), ", got ",
                        QuotedId(joint.id));
  }
  const std::string name = QuotedId(joint.id);
  if (joint.type != other.type) {
    return absl::StrCat(name, " is ", JointTypeName(joint.type), ", want ",
                        JointTypeName(other.type));
  }
  if (skeleton.span(index).parent != wanted.span(index).parent) {
    return absl::StrCat(name, " has another parent");
  }
  const RigidTransform& place = joint.parent_from_joint;
  const RigidTransform& other_place = other.parent_from_joint;
  const double way = (place.translation - other_place.translation).norm();
  const double turn = place.rotation.angularDistance(other_place.rotation);
  if (way > kSamePlaceM || turn > kSameTurnRad) {
    return absl::StrFormat("%s is %.4g m and %.4g rad from where it should be",
                           name, way, turn);
  }
  const double axis_turn = joint.axis.cross(other.axis).norm();
  const bool has_axis =
      joint.type == JointType::kRevolute || joint.type == JointType::kPrismatic;
  if (has_axis &&
      (axis_turn > kSameTurnRad || joint.axis.dot(other.axis) < 0)) {
    return absl::StrCat(name, " has another axis");
  }
  return "";
}

}  // namespace

absl::Status CheckSameJoints(const Skeleton& skeleton, const Skeleton& wanted) {
  Violations violations;
  if (skeleton.joint_count() != wanted.joint_count() ||
      skeleton.position_count() != wanted.position_count()) {
    violations.Add(
        "joints",
        absl::StrFormat("want %d with %d positions, got %d with %d",
                        wanted.joint_count(), wanted.position_count(),
                        skeleton.joint_count(), skeleton.position_count()));
    return violations.ToStatus();
  }
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const std::string difference = Difference(skeleton, wanted, i);
    if (difference.empty()) continue;
    violations.Add(absl::StrCat("joints[", i, "]"), difference);
  }
  return violations.ToStatus();
}

absl::StatusOr<MotionClip> OnSkeleton(
    const MotionClip& clip, std::shared_ptr<const Skeleton> skeleton) {
  if (clip.skeleton() == skeleton) return clip;
  if (absl::Status status = CheckSameJoints(*clip.skeleton(), *skeleton);
      !status.ok()) {
    return status;
  }
  return MotionClip::Create(std::move(skeleton), clip.CopyTracks(),
                            clip.properties());
}

}  // namespace gelenk
