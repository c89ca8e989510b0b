#include "client/cli/picture/stick_figure.h"

namespace gelenk::cli {
namespace {

// Marks `joint` and its ancestors with `half`; ancestors of both halves are
// trunk.
void MarkLimb(const Skeleton& skeleton, int joint, BodyHalf half,
              std::vector<BodyHalf>& halves, std::vector<bool>& seen) {
  for (; joint >= 0; joint = skeleton.span(joint).parent) {
    if (!seen[joint]) {
      seen[joint] = true;
      halves[joint] = half;
    } else if (halves[joint] != half) {
      halves[joint] = BodyHalf::kTrunk;
    }
  }
}

}  // namespace

std::vector<BodyHalf> HalvesOf(const Skeleton& skeleton,
                               const BodyParts& body) {
  std::vector<BodyHalf> halves(skeleton.joint_count(), BodyHalf::kTrunk);
  std::vector<bool> seen(skeleton.joint_count(), false);
  MarkLimb(skeleton, body.left_hand, BodyHalf::kLeft, halves, seen);
  MarkLimb(skeleton, body.right_hand, BodyHalf::kRight, halves, seen);
  MarkLimb(skeleton, body.left_foot, BodyHalf::kLeft, halves, seen);
  MarkLimb(skeleton, body.right_foot, BodyHalf::kRight, halves, seen);
  for (int i = 1; i < skeleton.joint_count(); ++i) {
    if (!seen[i]) halves[i] = halves[skeleton.span(i).parent];
  }
  return halves;
}

std::vector<Bone> BonesOf(const Skeleton& skeleton,
                          const std::vector<BodyHalf>& halves,
                          const WorldTransforms& world_from_joints) {
  std::vector<Bone> bones;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const int parent = skeleton.span(i).parent;
    if (parent < 0) continue;
    bones.push_back({world_from_joints[parent].translation,
                     world_from_joints[i].translation, halves[i]});
  }
  for (const EndEffector& effector : skeleton.end_effectors()) {
    const int joint = skeleton.FindJoint(effector.joint_id);
    const RigidTransform& world_from_joint = world_from_joints[joint];
    bones.push_back(
        {world_from_joint.translation,
         world_from_joint * effector.joint_from_end_effector.translation,
         halves[joint]});
  }
  return bones;
}

absl::string_view BoneClass(BodyHalf half) {
  switch (half) {
    case BodyHalf::kTrunk:
      return "bone trunk";
    case BodyHalf::kLeft:
      return "bone left";
    case BodyHalf::kRight:
      return "bone right";
  }
  return "bone";
}

}  // namespace gelenk::cli
