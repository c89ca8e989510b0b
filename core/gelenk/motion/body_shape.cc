#include "gelenk/motion/body_shape.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/motion/body_part_name.h"

namespace gelenk {
namespace {

// Chains are compared in pairs; a body has about 25 with fingers and face.
constexpr size_t kMaxChains = 64;
// Left and right of one capture differ by about 5 % in length.
constexpr double kMaxAsymmetry = 0.08;
// Shorter than this, relative to the longest, a chain is a finger or an ear.
constexpr double kMinLimb = 0.15;

// The rest pose as a tree of points.
struct Tree {
  explicit Tree(const Skeleton& skeleton)
      : children(skeleton.joint_count()),
        depth(skeleton.joint_count(), 0),
        bone(skeleton.joint_count(), 0),
        reach(skeleton.joint_count(), 0) {
    ForwardKinematics(skeleton, skeleton.rest_positions(), world_from_joints);
    for (int i = 1; i < skeleton.joint_count(); ++i) {
      const int parent = skeleton.span(i).parent;
      children[parent].push_back(i);
      depth[i] = depth[parent] + 1;
      bone[i] = (At(i) - At(parent)).norm();
      reach[i] = reach[parent] + bone[i];
    }
  }

  const Eigen::Vector3d& At(int joint) const {
    return world_from_joints[joint].translation;
  }

  WorldTransforms world_from_joints;
  std::vector<std::vector<int>> children;
  std::vector<int> depth;
  std::vector<double> bone;   // length to the parent
  std::vector<double> reach;  // length of the way to the root
};

// Joints below `top` down to `leaf`.
std::vector<int> ChainTo(const Skeleton& skeleton, int top, int leaf) {
  std::vector<int> chain;
  for (int i = leaf; i != top; i = skeleton.span(i).parent) chain.push_back(i);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

struct LimbPair {
  int meeting = -1;
  std::vector<int> first;
  std::vector<int> second;
  double length = 0;
};

// The ends of the longest chains.
std::vector<int> Leaves(const Tree& tree) {
  std::vector<int> leaves;
  for (size_t i = 0; i < tree.children.size(); ++i) {
    if (tree.children[i].empty()) leaves.push_back(static_cast<int>(i));
  }
  std::stable_sort(leaves.begin(), leaves.end(), [&tree](int a, int b) {
    return tree.reach[a] > tree.reach[b];
  });
  if (leaves.size() > kMaxChains) leaves.resize(kMaxChains);
  return leaves;
}

bool AreMirrored(const Tree& tree, const LimbPair& pair) {
  if (pair.first.size() != pair.second.size() || pair.first.size() < 3) {
    return false;
  }
  double asymmetry = 0;
  for (size_t i = 0; i < pair.first.size(); ++i) {
    asymmetry += std::abs(tree.bone[pair.first[i]] - tree.bone[pair.second[i]]);
  }
  return asymmetry <= kMaxAsymmetry * pair.length;
}

bool ShareAJoint(const LimbPair& a, const LimbPair& b) {
  for (int joint : {a.first[0], a.second[0]}) {
    if (joint == b.first[0] || joint == b.second[0]) return true;
  }
  return false;
}

// The longest mirrored pairs, none of which begins where another does.
std::vector<LimbPair> FindLimbPairs(const Skeleton& skeleton,
                                    const Tree& tree) {
  const std::vector<int> leaves = Leaves(tree);
  std::vector<LimbPair> pairs;
  for (size_t i = 0; i < leaves.size(); ++i) {
    for (size_t k = i + 1; k < leaves.size(); ++k) {
      LimbPair pair;
      pair.meeting = CommonAncestor(skeleton, leaves[i], leaves[k]);
      pair.length = tree.reach[leaves[i]] - tree.reach[pair.meeting];
      if (pair.length < kMinLimb * tree.reach[leaves[0]]) continue;
      pair.first = ChainTo(skeleton, pair.meeting, leaves[i]);
      pair.second = ChainTo(skeleton, pair.meeting, leaves[k]);
      if (AreMirrored(tree, pair)) pairs.push_back(std::move(pair));
    }
  }
  std::stable_sort(
      pairs.begin(), pairs.end(),
      [](const LimbPair& a, const LimbPair& b) { return a.length > b.length; });
  std::vector<LimbPair> limbs;
  for (LimbPair& pair : pairs) {
    const bool is_new = std::none_of(
        limbs.begin(), limbs.end(),
        [&pair](const LimbPair& b) { return ShareAJoint(pair, b); });
    if (is_new) limbs.push_back(std::move(pair));
  }
  return limbs;
}

// Past joints that stand on the same spot: the scalar joints of one wrist.
int LastOfScalarJoints(const Skeleton& skeleton, const Tree& tree, int joint) {
  while (VelocityCount(skeleton.joint(joint).type) == 1 &&
         tree.children[joint].size() == 1 &&
         tree.bone[tree.children[joint][0]] == 0) {
    joint = tree.children[joint][0];
  }
  return joint;
}

// The end of the last two long bones in a row: forearm or shin.
int WristOrAnkle(const Skeleton& skeleton, const Tree& tree,
                 const std::vector<int>& chain) {
  // Collar bone and upper arm can be longer than upper arm and forearm; hands
  // and feet are far shorter.
  constexpr double kAlmostAsLong = 0.75;
  std::vector<int> ends;
  std::vector<double> shorter;  // of the two bones that end there
  double bone_before = 0;
  for (int joint : chain) {
    // Joints on one spot have no bone between them.
    if (tree.bone[joint] == 0) continue;
    ends.push_back(joint);
    shorter.push_back(std::min(bone_before, tree.bone[joint]));
    bone_before = tree.bone[joint];
  }
  if (ends.empty()) return chain.back();
  const double long_enough =
      kAlmostAsLong * *std::max_element(shorter.begin(), shorter.end());
  size_t last = ends.size() - 1;
  while (shorter[last] < long_enough) --last;
  return LastOfScalarJoints(skeleton, tree, ends[last]);
}

// > 0 when the names of the chain say left, < 0 for right.
int SideByNames(const Skeleton& skeleton, const std::vector<int>& chain) {
  int balance = 0;
  for (int joint : chain) {
    const BodySide side = ReadBodyPartName(skeleton.joint(joint).id).side;
    if (side == BodySide::kLeft) ++balance;
    if (side == BodySide::kRight) --balance;
  }
  return balance;
}

// Where the body's left is in the rest pose.
Eigen::Vector3d LeftByShape(const Skeleton& skeleton, const Tree& tree,
                            const LimbPair& legs, const LimbPair& arms,
                            int one_foot, int other_foot) {
  const Eigen::Vector3d feet = (tree.At(one_foot) + tree.At(other_foot)) / 2;
  const Eigen::Vector3d up = (tree.At(arms.meeting) - feet).normalized();
  // Toes, or by the custom of most rigs +Z; of robots, whose up is +Z, +X.
  Eigen::Vector3d forward =
      tree.At(legs.first.back()) + tree.At(legs.second.back()) - 2 * feet;
  forward -= forward.dot(up) * up;
  if (forward.norm() < 1e-3 * legs.length) {
    const bool is_z_up = skeleton.up().z() > 0.5;
    forward = is_z_up ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
  }
  return up.cross(forward);
}

// Swaps a pair so that `first` is the left one.
void PutLeftFirst(const Skeleton& skeleton, const Tree& tree,
                  const Eigen::Vector3d& left, LimbPair& pair) {
  const int by_names =
      SideByNames(skeleton, pair.first) - SideByNames(skeleton, pair.second);
  const double by_shape =
      left.dot(tree.At(pair.first.back()) - tree.At(pair.second.back()));
  const bool first_is_left = by_names != 0 ? by_names > 0 : by_shape >= 0;
  if (!first_is_left) std::swap(pair.first, pair.second);
}

// The end of the longest chain above `chest` that leads to no arm.
int FindHead(const Skeleton& skeleton, const Tree& tree, int chest,
             const std::vector<int>& arms) {
  int head = -1;
  for (int i = chest + 1; i < skeleton.joint_count(); ++i) {
    if (!tree.children[i].empty()) continue;
    // Below the chest, and through neither shoulder.
    if (CommonAncestor(skeleton, i, chest) != chest) continue;
    const bool in_arm = std::any_of(arms.begin(), arms.end(), [&](int hand) {
      return CommonAncestor(skeleton, i, hand) != chest;
    });
    if (in_arm) continue;
    if (head < 0 || tree.reach[i] > tree.reach[head]) head = i;
  }
  if (head < 0) return -1;
  // Eyes and jaw hang from the head.
  const int parent = skeleton.span(head).parent;
  if (parent != chest && tree.children[parent].size() > 1) head = parent;
  return LastOfScalarJoints(skeleton, tree, head);
}

}  // namespace

int CommonAncestor(const Skeleton& skeleton, int a, int b) {
  // Parents have smaller indices.
  while (a != b) {
    int& later = a > b ? a : b;
    later = skeleton.span(later).parent;
  }
  return a;
}

int FindHeadByShape(const Skeleton& skeleton, int left_hand, int right_hand) {
  return FindHead(skeleton, Tree(skeleton),
                  CommonAncestor(skeleton, left_hand, right_hand),
                  {left_hand, right_hand});
}

BodyParts FindBodyPartsByShape(const Skeleton& skeleton) {
  BodyParts parts;
  if (skeleton.joint_count() == 0) return parts;
  const Tree tree(skeleton);
  std::vector<LimbPair> limbs = FindLimbPairs(skeleton, tree);
  if (limbs.size() < 2) return parts;
  LimbPair& legs = limbs[0];
  LimbPair& arms = limbs[1];
  if (tree.depth[legs.meeting] > tree.depth[arms.meeting]) {
    std::swap(legs, arms);
  }
  const auto end_of = [&](const std::vector<int>& chain) {
    return WristOrAnkle(skeleton, tree, chain);
  };
  const Eigen::Vector3d left = LeftByShape(
      skeleton, tree, legs, arms, end_of(legs.first), end_of(legs.second));
  PutLeftFirst(skeleton, tree, left, legs);
  PutLeftFirst(skeleton, tree, left, arms);
  parts.hips = legs.meeting;
  parts.left_foot = end_of(legs.first);
  parts.right_foot = end_of(legs.second);
  parts.left_hand = end_of(arms.first);
  parts.right_hand = end_of(arms.second);
  parts.head = FindHead(skeleton, tree, arms.meeting,
                        {parts.left_hand, parts.right_hand});
  parts.evidence = BodyParts::Evidence::kShape;
  return parts;
}

}  // namespace gelenk
