#include "client/cli/vmc/vmc_performer.h"

#include <initializer_list>
#include <string>
#include <utility>

#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::cli {
namespace {

// Bones do not grow; trackers that stretch them do it by less.
constexpr double kSameLength_m = 0.05;

bool HasAny(const VmcFrame& frame, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (frame.bones[FindHumanBone(name)]) return true;
  }
  return false;
}

// The nearest bone above that the frame has.
int ParentIn(const VmcFrame& frame, int bone) {
  int parent = HumanBones()[bone].parent;
  while (parent >= 0 && !frame.bones[parent]) {
    parent = HumanBones()[parent].parent;
  }
  return parent;
}

}  // namespace

absl::StatusOr<VmcPerformer> VmcPerformer::Create(const VmcFrame& frame) {
  if (!frame.bones[kHipsBone]) {
    return absl::FailedPreconditionError("no hips have come yet");
  }
  if (!HasAny(frame, {"LeftFoot", "RightFoot", "LeftHand", "RightHand"})) {
    return absl::FailedPreconditionError("no hands and feet have come yet");
  }
  SkeletonBuilder builder;
  VmcPerformer performer;
  performer.joints_.fill(-1);
  int count = 0;
  for (int i = 0; i < kHumanBoneCount; ++i) {
    if (!frame.bones[i]) continue;
    Joint joint;
    joint.id = std::string(HumanBones()[i].name);
    const int parent = ParentIn(frame, i);
    if (parent >= 0) {
      joint.parent_id = std::string(HumanBones()[parent].name);
      joint.type = JointType::kSpherical;
      joint.parent_from_joint.translation = frame.bones[i]->translation;
    } else {
      joint.type = JointType::kFree;
    }
    builder.AddJoint(std::move(joint));
    performer.joints_[i] = count++;
  }
  absl::StatusOr<std::shared_ptr<const Skeleton>> skeleton = builder.Build();
  if (!skeleton.ok()) return skeleton.status();
  performer.skeleton_ = *std::move(skeleton);
  return performer;
}

bool VmcPerformer::Fits(const VmcFrame& frame) const {
  for (int i = 0; i < kHumanBoneCount; ++i) {
    if (frame.bones[i].has_value() != (joints_[i] >= 0)) return false;
    if (i == kHipsBone || joints_[i] < 0) continue;
    const Eigen::Vector3d& offset =
        skeleton_->joint(joints_[i]).parent_from_joint.translation;
    if ((frame.bones[i]->translation - offset).norm() > kSameLength_m) {
      return false;
    }
  }
  return true;
}

std::vector<JointMapOverride> VmcPerformer::roles() const {
  std::vector<std::pair<std::string, std::string>> joint_of_bone;
  for (int i = 0; i < kHumanBoneCount; ++i) {
    const std::string name(HumanBones()[i].name);
    if (joints_[i] >= 0) joint_of_bone.emplace_back(name, name);
  }
  return OverridesOfHumanoid(joint_of_bone);
}

Eigen::VectorXd VmcPerformer::PositionsOf(const VmcFrame& frame) const {
  Eigen::VectorXd positions = skeleton_->rest_positions();
  for (int i = 0; i < kHumanBoneCount; ++i) {
    if (joints_[i] < 0 || !frame.bones[i]) continue;
    const JointSpan& span = skeleton_->span(joints_[i]);
    const RigidTransform place =
        i == kHipsBone ? frame.root * *frame.bones[i] : *frame.bones[i];
    if (i == kHipsBone) {
      positions.segment<3>(span.position_offset) = place.translation;
    }
    StoreXyzw(place.rotation, positions.data() + span.quaternion_offset);
  }
  return positions;
}

}  // namespace gelenk::cli
