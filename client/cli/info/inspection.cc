#include "client/cli/info/inspection.h"

#include "gelenk/motion/body_height.h"

namespace gelenk::cli {
namespace {

std::vector<std::vector<std::string>> ChannelsOf(const SkeletonFile& file) {
  std::vector<std::vector<std::string>> channels(file.skeleton->joint_count());
  if (!file.clip) return channels;
  const std::vector<BvhJoint>& joints = file.clip->document.joints;
  for (size_t i = 0; i < joints.size(); ++i) {
    for (BvhChannel channel : joints[i].channels) {
      channels[file.clip->import.joints[i]].emplace_back(
          BvhChannelName(channel));
    }
  }
  return channels;
}

std::vector<std::string> TipsOf(const Skeleton& skeleton) {
  std::vector<bool> is_tip(skeleton.joint_count(), true);
  for (int i = 1; i < skeleton.joint_count(); ++i) {
    is_tip[skeleton.span(i).parent] = false;
  }
  std::vector<std::vector<std::string>> effectors(skeleton.joint_count());
  for (const EndEffector& effector : skeleton.end_effectors()) {
    effectors[skeleton.FindJoint(effector.joint_id)].push_back(effector.id);
  }
  std::vector<std::string> tips;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    if (!is_tip[i]) continue;
    if (effectors[i].empty()) effectors[i] = {skeleton.joint(i).id};
    tips.insert(tips.end(), effectors[i].begin(), effectors[i].end());
  }
  return tips;
}

}  // namespace

bool SharesItsJointsFrame(const EndEffector& effector) {
  const RigidTransform& offset = effector.joint_from_end_effector;
  return offset.translation.isZero(0) &&
         offset.rotation.coeffs() == Eigen::Quaterniond::Identity().coeffs();
}

std::vector<std::string> EffectorsAt(const Skeleton& skeleton, int joint) {
  std::vector<std::string> ids;
  for (const EndEffector& effector : skeleton.end_effectors()) {
    if (effector.joint_id == skeleton.joint(joint).id &&
        SharesItsJointsFrame(effector)) {
      ids.push_back(effector.id);
    }
  }
  return ids;
}

Inspection Inspect(const SkeletonFile& file) {
  Inspection inspection;
  inspection.file = &file;
  inspection.body = FindBodyParts(*file.skeleton);
  inspection.height_m = BodyHeight(*file.skeleton, inspection.body);
  if (file.clip) {
    inspection.first_frame_jump =
        FindFirstFrameJump(*file.skeleton, file.clip->poses);
  }
  inspection.channels = ChannelsOf(file);
  inspection.tips = TipsOf(*file.skeleton);
  return inspection;
}

std::vector<NamedPart> PartsOf(const BodyParts& body) {
  return {{"hips", body.hips},
          {"left_hand", body.left_hand},
          {"right_hand", body.right_hand},
          {"left_foot", body.left_foot},
          {"right_foot", body.right_foot},
          {"head", body.head}};
}

}  // namespace gelenk::cli
