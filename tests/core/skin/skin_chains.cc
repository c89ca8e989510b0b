#include "tests/core/skin/skin_chains.h"

#include <numbers>
#include <string>

#include "absl/strings/str_cat.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::testing {
namespace {

Joint BallJoint(const std::string& id, const std::string& parent,
                const RigidTransform& parent_from_joint) {
  Joint joint;
  joint.id = id;
  joint.parent_id = parent;
  joint.type = JointType::kSpherical;
  joint.parent_from_joint = parent_from_joint;
  return joint;
}

EndEffector Tip(const std::string& id, const std::string& joint,
                double length_m) {
  EndEffector tip;
  tip.id = id;
  tip.joint_id = joint;
  tip.joint_from_end_effector.translation.x() = length_m;
  return tip;
}

Eigen::Quaterniond RandomTurn(Random& random, double most_rad) {
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(Uniform(random, 0, most_rad), RandomDirection(random)));
}

}  // namespace

std::shared_ptr<const Skeleton> BallChain(Random& random,
                                          const std::vector<double>& lengths_m,
                                          double rest_bend_rad) {
  SkeletonBuilder builder;
  RigidTransform place;
  for (size_t i = 0; i < lengths_m.size(); ++i) {
    builder.AddJoint(BallJoint(absl::StrCat("j", i),
                               i == 0 ? "" : absl::StrCat("j", i - 1), place));
    place.translation = {lengths_m[i], 0, 0};
    place.rotation = RandomTurn(random, rest_bend_rad);
  }
  builder.AddEndEffector(
      Tip("tip", absl::StrCat("j", lengths_m.size() - 1), lengths_m.back()));
  return builder.Build().value();
}

std::vector<double> RandomLengths(Random& random, int count) {
  std::vector<double> lengths;
  for (int i = 0; i < count; ++i) lengths.push_back(Uniform(random, 0.3, 2));
  return lengths;
}

Eigen::VectorXd BentPose(Random& random, const Skeleton& skeleton,
                         double bend_rad) {
  Eigen::VectorXd positions = NeutralPositions(skeleton);
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    StoreXyzw(RandomTurn(random, bend_rad),
              positions.data() + skeleton.span(i).quaternion_offset);
  }
  return positions;
}

SkinMuscles RandomMuscles(Random& random, const Skeleton& skeleton) {
  SkinMuscles muscles;
  for (const Joint& joint : skeleton.joints()) {
    Muscle muscle;
    muscle.id = muscle.link_id = joint.id;
    muscle.mode = MuscleMode::kExplicit;
    for (int k = 0; k < 2; ++k) {
      muscle.scale_s[k] = Uniform(random, 0.6, 1.8);
      muscle.scale_t[k] = Uniform(random, 0.6, 1.8);
      muscle.pivot_m[k] = Uniform(random, -0.2, 0.2);
    }
    muscles.muscles.push_back(muscle);
  }
  return muscles;
}

std::shared_ptr<const Skeleton> TwoLinkArm(const Eigen::Vector3d& axis) {
  SkeletonBuilder builder;
  builder.AddJoint(BallJoint("upper", "", {}));
  Joint elbow;
  elbow.id = "lower";
  elbow.parent_id = "upper";
  elbow.type = JointType::kRevolute;
  elbow.axis = axis;
  elbow.parent_from_joint.translation.x() = 1;
  builder.AddJoint(elbow);
  builder.AddEndEffector(Tip("hand", "lower", 1));
  return builder.Build().value();
}

Eigen::VectorXd ElbowAt(const Skeleton& arm, double angle_rad) {
  Eigen::VectorXd positions = NeutralPositions(arm);
  positions[4] = angle_rad;
  return positions;
}

std::shared_ptr<const Skeleton> PelvisWithLeg() {
  SkeletonBuilder builder;
  RigidTransform place;
  builder.AddJoint(BallJoint("pelvis", "", place));
  place.translation.x() = 1;
  builder.AddJoint(BallJoint("spine", "pelvis", place));
  builder.AddJoint(BallJoint("neck", "spine", place));
  builder.AddEndEffector(Tip("head", "neck", 0.5));
  place.rotation =
      Eigen::AngleAxisd(-0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ());
  place.translation = {0.5, -0.2, 0};
  builder.AddJoint(BallJoint("thigh", "pelvis", place));
  place.rotation.setIdentity();
  place.translation = {0.8, 0, 0};
  builder.AddJoint(BallJoint("shank", "thigh", place));
  builder.AddEndEffector(Tip("foot", "shank", 0.7));
  return builder.Build().value();
}

}  // namespace gelenk::testing
