#include "tests/testing/random_skeleton.h"

#include <numbers>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"

namespace gelenk::testing {
namespace {

constexpr double kPi = std::numbers::pi;

// Numbers of q that the box limits of `type` bound.
int BoundedCount(JointType type) {
  switch (type) {
    case JointType::kRevolute:
    case JointType::kPrismatic:
      return 1;
    case JointType::kPlanar:
    case JointType::kFree:
      return 3;
    case JointType::kFixed:
    case JointType::kSpherical:
      return 0;
  }
  return 0;
}

// A cone, with or without a twist range. A range alone would be ill-posed: near
// a swing of pi the twist turns arbitrarily fast.
void LimitRotation(Random& random, JointLimits& limits) {
  if (WithProbability(random, 0.4)) {
    limits.swing_cone_rad = Uniform(random, 0.05, kPi);
    return;
  }
  limits.swing_cone_rad = Uniform(random, 0.05, 2.5);
  // Anywhere it may lie, across pi too.
  limits.twist_lower_rad = Uniform(random, -2 * kPi, kPi);
  limits.twist_upper_rad = *limits.twist_lower_rad + Uniform(random, 0, kPi);
}

JointLimits RandomLimits(Random& random, JointType type,
                         const SkeletonRecipe& recipe) {
  JointLimits limits;
  for (int i = 0; i < BoundedCount(type); ++i) {
    const bool frozen = WithProbability(random, recipe.frozen);
    const double lower = Uniform(random, -2, 0);
    limits.lower.push_back(lower);
    limits.upper.push_back(frozen ? lower : Uniform(random, 0, 2));
  }
  if (type == JointType::kSpherical || type == JointType::kFree) {
    LimitRotation(random, limits);
  }
  return limits;
}

// The joint that `joint` follows, if it is to follow one.
std::optional<Mimic> RandomMimic(Random& random, const Joint& joint,
                                 const std::vector<Joint>& earlier,
                                 const SkeletonRecipe& recipe) {
  if (joint.type != JointType::kRevolute &&
      joint.type != JointType::kPrismatic) {
    return std::nullopt;
  }
  std::vector<std::string> ids;
  for (const Joint& other : earlier) {
    if (other.type != JointType::kRevolute &&
        other.type != JointType::kPrismatic) {
      continue;
    }
    if (!other.mimic) ids.push_back(other.id);
  }
  if (ids.empty() || !WithProbability(random, recipe.mimicking)) {
    return std::nullopt;
  }
  const int chosen = UniformIndex(random, static_cast<int>(ids.size()));
  return Mimic{ids[chosen], Uniform(random, -1.5, 1.5),
               Uniform(random, -0.5, 0.5)};
}

Joint RandomJoint(Random& random, const std::vector<Joint>& earlier,
                  const SkeletonRecipe& recipe) {
  const int count = static_cast<int>(earlier.size());
  Joint joint;
  joint.id = absl::StrCat("j", count);
  if (count > 0) {
    const bool branch = WithProbability(random, recipe.branching);
    const int parent = branch ? UniformIndex(random, count) : count - 1;
    joint.parent_id = absl::StrCat("j", parent);
  }
  const int types = static_cast<int>(recipe.types.size());
  joint.type = recipe.types[UniformIndex(random, types)];
  joint.parent_from_joint = RandomTransform(random, recipe.offset_m);
  joint.axis = RandomDirection(random);
  joint.mimic = RandomMimic(random, joint, earlier, recipe);
  // The one who is followed answers for the limits.
  if (!joint.mimic && WithProbability(random, recipe.limited)) {
    joint.limits = RandomLimits(random, joint.type, recipe);
  }
  return joint;
}

std::vector<std::string> LeafIds(const std::vector<Joint>& joints) {
  std::set<std::string> parents;
  for (const Joint& joint : joints) parents.insert(joint.parent_id);
  std::vector<std::string> leaves;
  for (const Joint& joint : joints) {
    if (!parents.contains(joint.id)) leaves.push_back(joint.id);
  }
  return leaves;
}

}  // namespace

SkeletonBuilder RandomSkeletonBuilder(Random& random,
                                      const SkeletonRecipe& recipe) {
  SkeletonBuilder builder;
  std::vector<Joint> joints;
  for (int i = 0; i < recipe.joint_count; ++i) {
    joints.push_back(RandomJoint(random, joints, recipe));
    builder.AddJoint(joints.back());
  }
  int effector_count = 0;
  for (const std::string& leaf : LeafIds(joints)) {
    builder.AddEndEffector({absl::StrCat("e", effector_count++), leaf,
                            RandomTransform(random, recipe.offset_m)});
  }
  return builder;
}

std::shared_ptr<const Skeleton> RandomSkeleton(Random& random,
                                               const SkeletonRecipe& recipe) {
  return RandomSkeletonBuilder(random, recipe).Build().value();
}

}  // namespace gelenk::testing
