#include "tests/core/ik/bone_chains.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::testing {
namespace {

// Hangs joints one from the other.
class ChainBuilder {
 public:
  void Add(JointType type, const Eigen::Vector3d& axis,
           const RigidTransform& parent_from_joint, const JointLimits& limits) {
    Joint joint;
    joint.id = absl::StrCat("j", count_);
    if (count_ > 0) joint.parent_id = absl::StrCat("j", count_ - 1);
    joint.type = type;
    joint.axis = axis;
    joint.parent_from_joint = parent_from_joint;
    if (type == JointType::kRevolute) joint.limits = limits;
    builder_.AddJoint(std::move(joint));
    ++count_;
  }

  std::shared_ptr<const Skeleton> Build(const Eigen::Vector3d& tip) {
    RigidTransform joint_from_tip;
    joint_from_tip.translation = tip;
    builder_.AddEndEffector(
        {"tip", absl::StrCat("j", count_ - 1), joint_from_tip});
    return builder_.Build().value();
  }

 private:
  SkeletonBuilder builder_;
  int count_ = 0;
};

Eigen::Vector3d RandomBone(Random& random) {
  return Uniform(random, 0.02, 0.2) * RandomDirection(random);
}

}  // namespace

std::shared_ptr<const Skeleton> RandomBones(Random& random, BoneJoints joints,
                                            int bone_count,
                                            const JointLimits& limits) {
  ChainBuilder builder;
  Eigen::Vector3d axis = RandomDirection(random);
  for (int i = 0; i < bone_count; ++i) {
    RigidTransform rest = {RandomRotation(random), RandomBone(random)};
    if (joints == BoneJoints::kHinges) {
      if (i > 0) {
        // The axis before, from the next frame, either way round.
        axis = rest.rotation.conjugate() * axis;
        if (WithProbability(random, 0.5)) axis = -axis;
      }
      builder.Add(JointType::kRevolute, axis, rest, limits);
    } else if (joints == BoneJoints::kSpherical) {
      builder.Add(JointType::kSpherical, Eigen::Vector3d::UnitX(), rest,
                  limits);
    } else {
      const Eigen::Vector3d first = RandomDirection(random);
      const Eigen::Vector3d second =
          first.cross(RandomDirection(random)).normalized();
      const Eigen::Vector3d third =
          second.cross(RandomDirection(random)).normalized();
      builder.Add(JointType::kRevolute, first, rest, limits);
      builder.Add(JointType::kRevolute, second, {}, limits);
      builder.Add(JointType::kRevolute, third, {}, limits);
    }
  }
  return builder.Build(RandomBone(random));
}

std::shared_ptr<const Skeleton> EqualBones(int bone_count, BoneJoints joints,
                                           const JointLimits& limits) {
  ChainBuilder builder;
  RigidTransform rest;
  for (int i = 0; i < bone_count; ++i) {
    if (joints == BoneJoints::kHinges) {
      builder.Add(JointType::kRevolute, Eigen::Vector3d::UnitZ(), rest, limits);
    } else if (joints == BoneJoints::kSpherical) {
      builder.Add(JointType::kSpherical, Eigen::Vector3d::UnitX(), rest,
                  limits);
    } else {
      builder.Add(JointType::kRevolute, Eigen::Vector3d::UnitZ(), rest, limits);
      builder.Add(JointType::kRevolute, Eigen::Vector3d::UnitY(), {}, limits);
      builder.Add(JointType::kRevolute, Eigen::Vector3d::UnitX(), {}, limits);
    }
    rest.translation.x() = 1.0 / bone_count;
  }
  return builder.Build(rest.translation);
}

}  // namespace gelenk::testing
