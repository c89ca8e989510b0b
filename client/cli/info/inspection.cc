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

}  // namespace

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
