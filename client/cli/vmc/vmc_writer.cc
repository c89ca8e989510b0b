#include "client/cli/vmc/vmc_writer.h"

#include <array>
#include <utility>

#include "client/cli/vmc/human_bone.h"
#include "client/cli/vmc/osc_packet.h"
#include "client/cli/vmc/unity_axes.h"

namespace gelenk::cli {
namespace {

OscMessage PlaceMessage(std::string path, std::string name,
                        const RigidTransform& place) {
  const RigidTransform unity = MirrorAxes(place);
  OscMessage message{std::move(path), {std::move(name)}};
  for (double number : unity.translation) {
    message.arguments.emplace_back(static_cast<float>(number));
  }
  for (double number : unity.rotation.coeffs()) {
    message.arguments.emplace_back(static_cast<float>(number));
  }
  return message;
}

// Of bones that share a role the nearer to the end: a chest without an upper
// one is that.
constexpr absl::string_view kUpperChest = "UpperChest";

}  // namespace

VmcWriter::VmcWriter(std::shared_ptr<const BodyModel> body)
    : body_(std::move(body)), reader_(body_) {
  std::array<int, kHumanBoneCount> sent;
  sent.fill(-1);
  for (int i = 0; i < kHumanBoneCount; ++i) {
    const HumanBone& bone = HumanBones()[i];
    const std::optional<BodyRole> role = RoleOfHumanoidBone(bone.name);
    if (!role || !body_->map.Has(*role) || bone.name == kUpperChest) continue;
    int parent = bone.parent;
    while (parent >= 0 && sent[parent] < 0)
      parent = HumanBones()[parent].parent;
    sent[i] = static_cast<int>(bones_.size());
    bones_.push_back({std::string(bone.name), *role,
                      parent >= 0 ? bones_[sent[parent]].role : *role});
  }
}

std::string VmcWriter::Write(const Eigen::VectorXd& positions, double time_s) {
  reader_.Read(positions, pose_);
  std::vector<OscMessage> messages;
  messages.push_back({"/VMC/Ext/OK", {1}});
  messages.push_back({"/VMC/Ext/T", {static_cast<float>(time_s)}});
  messages.push_back(PlaceMessage("/VMC/Ext/Root/Pos", "root", {}));
  for (const Bone& bone : bones_) {
    RigidTransform place = {pose_.rotation(bone.role),
                            pose_.position(bone.role)};
    if (bone.parent != bone.role) {
      const RigidTransform parent = {pose_.rotation(bone.parent),
                                     pose_.position(bone.parent)};
      place = parent.Inverse() * place;
    }
    messages.push_back(PlaceMessage("/VMC/Ext/Bone/Pos", bone.name, place));
  }
  return WriteOscBundle(messages);
}

}  // namespace gelenk::cli
