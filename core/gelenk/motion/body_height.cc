#include "gelenk/motion/body_height.h"

#include <algorithm>
#include <vector>

#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/motion/body_shape.h"

namespace gelenk {
namespace {

// Hair or a hat adds no more than this to the way from foot to head.
constexpr double kMaxAboveHead = 0.25;

double BoneLength(const WorldTransforms& world_from_joints,
                  const Skeleton& skeleton, int joint) {
  const int parent = skeleton.span(joint).parent;
  return (world_from_joints[joint].translation -
          world_from_joints[parent].translation)
      .norm();
}

// The length of the bones from `joint` up to `ancestor`.
double WayUp(const WorldTransforms& world_from_joints, const Skeleton& skeleton,
             int joint, int ancestor) {
  double way = 0;
  for (; joint != ancestor; joint = skeleton.span(joint).parent) {
    way += BoneLength(world_from_joints, skeleton, joint);
  }
  return way;
}

// The longest way from `head` to a joint or end effector below it.
double WayAbove(const WorldTransforms& world_from_joints,
                const Skeleton& skeleton, int head) {
  std::vector<double> ways(skeleton.joint_count(), -1);
  ways[head] = 0;
  double longest = 0;
  for (int i = head + 1; i < skeleton.joint_count(); ++i) {
    const double below = ways[skeleton.span(i).parent];
    if (below < 0) continue;
    ways[i] = below + BoneLength(world_from_joints, skeleton, i);
    longest = std::max(longest, ways[i]);
  }
  for (const EndEffector& effector : skeleton.end_effectors()) {
    const double below = ways[skeleton.FindJoint(effector.joint_id)];
    if (below < 0) continue;
    longest = std::max(
        longest, below + effector.joint_from_end_effector.translation.norm());
  }
  return longest;
}

}  // namespace

std::optional<double> BodyHeight(const Skeleton& skeleton,
                                 const BodyParts& body) {
  if (!body.IsComplete()) return std::nullopt;
  WorldTransforms world_from_joints;
  ForwardKinematics(skeleton, skeleton.rest_positions(), world_from_joints);
  const int meeting = CommonAncestor(skeleton, body.left_foot, body.head);
  const double way =
      WayUp(world_from_joints, skeleton, body.left_foot, meeting) +
      WayUp(world_from_joints, skeleton, body.head, meeting);
  const double above = WayAbove(world_from_joints, skeleton, body.head);
  return way + std::min(above, kMaxAboveHead * way);
}

}  // namespace gelenk
