#include "tests/testing/live_hands.h"

#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"

namespace gelenk::testing {
namespace {

std::shared_ptr<const Skeleton> HumanArm() {
  SkeletonBuilder builder;
  Joint shoulder;
  shoulder.id = "shoulder";
  shoulder.type = JointType::kSpherical;
  builder.AddJoint(shoulder);
  Joint elbow;
  elbow.id = "elbow";
  elbow.parent_id = "shoulder";
  elbow.type = JointType::kRevolute;
  elbow.axis = Eigen::Vector3d::UnitY();
  elbow.parent_from_joint.translation.x() = 0.3;
  elbow.limits.lower = {0};
  elbow.limits.upper = {2.6};
  builder.AddJoint(elbow);
  Joint wrist;
  wrist.id = "wrist";
  wrist.parent_id = "elbow";
  wrist.type = JointType::kSpherical;
  wrist.parent_from_joint.translation.x() = 0.26;
  builder.AddJoint(wrist);
  EndEffector palm;
  palm.id = "tip";
  palm.joint_id = "wrist";
  palm.joint_from_end_effector.translation.x() = 0.08;
  builder.AddEndEffector(palm);
  return *builder.Build();
}

}  // namespace

std::vector<Hand> LiveHands() {
  std::vector<Hand> hands;
  Eigen::VectorXd panda(7);
  panda << 0, -0.6, 0, -2.2, 0, 1.6, 0.8;
  hands.push_back({"panda", PandaArm(), panda});
  Eigen::VectorXd ur5(6);
  ur5 << 0.3, -1.4, 1.6, -1.2, -1.4, 0.2;
  hands.push_back({"ur5", Ur5Arm(), ur5});
  const auto arm = HumanArm();
  Eigen::VectorXd q = NeutralPositions(*arm);
  StoreXyzw(ExpRotation(Eigen::Vector3d(0.1, 0.3, -0.4)), &q[0]);
  q[4] = 1.2;
  hands.push_back({"human arm", arm, q});
  return hands;
}

WayOut WayOutOf(const Hand& hand) {
  const auto origin = [&](const std::string& id) {
    return EffectorPose(*hand.skeleton, hand.start, id).translation;
  };
  const Eigen::Vector3d from = origin(hand.tip());
  const Eigen::Vector3d base = origin(hand.skeleton->joint(1).id);
  return {from, (from - base).normalized()};
}

}  // namespace gelenk::testing
