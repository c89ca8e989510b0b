#include "tests/testing/random_goals.h"

#include <string>
#include <vector>

#include "gelenk/kinematics/forward_kinematics.h"
#include "tests/testing/ik_targets.h"

namespace gelenk::testing {
namespace {

std::string RandomEffector(Random& random, const Skeleton& skeleton) {
  if (skeleton.end_effectors().empty() || WithProbability(random, 0.3)) {
    return skeleton.joint(UniformIndex(random, skeleton.joint_count())).id;
  }
  const int count = static_cast<int>(skeleton.end_effectors().size());
  return skeleton.end_effectors()[UniformIndex(random, count)].id;
}

AxisMask RandomMask(Random& random) {
  if (WithProbability(random, 0.4)) return {};
  return {WithProbability(random, 0.6), WithProbability(random, 0.6),
          WithProbability(random, 0.6)};
}

std::optional<GoalKind> RandomPole(Random& random, const Skeleton& skeleton,
                                   const Eigen::VectorXd& truth) {
  std::vector<int> path;
  for (int j = UniformIndex(random, skeleton.joint_count()); j >= 0;
       j = skeleton.span(j).parent) {
    path.push_back(j);
  }
  const int depth = static_cast<int>(path.size());
  if (depth < 3) return std::nullopt;
  const int mid = 1 + UniformIndex(random, depth - 2);
  const int root = mid + 1 + UniformIndex(random, depth - mid - 1);
  PoleGoal pole;
  pole.root_joint_id = skeleton.joint(path[root]).id;
  pole.mid_joint_id = skeleton.joint(path[mid]).id;
  pole.tip_joint_id = skeleton.joint(path[0]).id;
  const auto origin = [&](const std::string& id) {
    return EffectorPose(skeleton, truth, id).translation;
  };
  // Beyond the bend.
  pole.world_point =
      2 * origin(pole.mid_joint_id) -
      0.5 * (origin(pole.root_joint_id) + origin(pole.tip_joint_id));
  return pole;
}

Eigen::Vector3d CenterAt(const Skeleton& skeleton,
                         const Eigen::VectorXd& truth) {
  WorldTransforms frames;
  ForwardKinematics(skeleton, truth, frames);
  double mass = 0;
  for (const Joint& joint : skeleton.joints()) mass += joint.link_mass_kg;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const Joint& joint = skeleton.joint(i);
    moment += (mass > 0 ? joint.link_mass_kg : 1) *
              (frames[i] * joint.link_center_of_mass);
  }
  return moment / (mass > 0 ? mass : skeleton.joint_count());
}

}  // namespace

std::optional<GoalKind> RandomGoal(Random& random, const Skeleton& skeleton,
                                   int kind, const Eigen::VectorXd& truth) {
  const std::string id = RandomEffector(random, skeleton);
  const RigidTransform pose = EffectorPose(skeleton, truth, id);
  switch (kind) {
    case kPositionGoal:
      return PositionGoal{id, pose.translation, RandomMask(random)};
    case kRotationGoal:
      return RotationGoal{id, pose.rotation, RandomMask(random)};
    case kPoseGoal:
      return PoseGoal{id, pose, Uniform(random, 0.3, 2), RandomMask(random),
                      RandomMask(random)};
    case kAimGoal: {
      const Eigen::Vector3d axis = RandomDirection(random);
      return AimGoal{id, axis, pose * (Uniform(random, 0.5, 3) * axis)};
    }
    case kPoleGoal:
      return RandomPole(random, skeleton, truth);
    case kRelativeGoal: {
      const std::string other = RandomEffector(random, skeleton);
      return RelativeGoal{other, id,
                          EffectorPose(skeleton, truth, other).Inverse() * pose,
                          Uniform(random, 0.3, 2)};
    }
    case kCenterOfMassGoal:
      return CenterOfMassGoal{CenterAt(skeleton, truth), RandomMask(random)};
    default: {
      const Eigen::Vector3d normal = RandomDirection(random);
      return HalfSpaceGoal{
          id, normal, normal.dot(pose.translation) - Uniform(random, 0, 0.1)};
    }
  }
}

}  // namespace gelenk::testing
