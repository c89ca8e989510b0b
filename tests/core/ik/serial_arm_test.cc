// Which problems are arms, and that an arm's frames put its tip where forward
// kinematics does.
#include "gelenk/ik/serial_arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::PandaArm;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::PoseGoalFor;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RandomTransform;
using ::gelenk::testing::RotationGoalFor;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::UniformIndex;

constexpr double kRounding = 1e-12;

IkProblem ProblemOf(const std::shared_ptr<const Skeleton>& skeleton,
                    std::vector<Goal> goals) {
  return IkProblem::Create(skeleton, std::move(goals)).value();
}

bool IsArm(const std::vector<Joint>& joints) {
  SkeletonBuilder builder;
  for (const Joint& joint : joints) builder.AddJoint(joint);
  RigidTransform tip;
  tip.translation = {0.3, 0.2, 0.1};
  builder.AddEndEffector({"tip", joints.back().id, tip});
  return ProblemOf(builder.Build().value(), {PoseGoalFor("tip", {})}).arm() !=
         nullptr;
}

Joint Link(const std::string& id, const std::string& parent, JointType type) {
  Joint joint;
  joint.id = id;
  joint.parent_id = parent;
  joint.type = type;
  joint.parent_from_joint.translation = {0.1, 0, 0.2};
  return joint;
}

TEST(SerialArmTest, RevoluteAndPrismaticJointsInARow) {
  EXPECT_TRUE(IsArm({Link("a", "", JointType::kRevolute)}));
  EXPECT_TRUE(IsArm({Link("a", "", JointType::kPrismatic),
                     Link("b", "a", JointType::kRevolute)}));
  EXPECT_TRUE(IsArm({Link("a", "", JointType::kFixed),
                     Link("b", "a", JointType::kRevolute),
                     Link("c", "b", JointType::kFixed)}));
}

TEST(SerialArmTest, OtherJointsMakeNoArm) {
  for (JointType type :
       {JointType::kSpherical, JointType::kPlanar, JointType::kFree}) {
    EXPECT_FALSE(
        IsArm({Link("a", "", type), Link("b", "a", JointType::kRevolute)}));
  }
  EXPECT_FALSE(IsArm({Link("a", "", JointType::kFixed)}));
  Joint mimic = Link("b", "a", JointType::kRevolute);
  mimic.mimic = Mimic{"a", 1, 0};
  EXPECT_FALSE(IsArm({Link("a", "", JointType::kRevolute), mimic}));
}

TEST(SerialArmTest, WhatIsBesideTheWayToTheTipDoesNotMatter) {
  Joint mimic = Link("c", "a", JointType::kRevolute);
  mimic.mimic = Mimic{"a", 1, 0};
  EXPECT_TRUE(IsArm({Link("a", "", JointType::kRevolute),
                     Link("ball", "a", JointType::kSpherical), mimic,
                     Link("b", "a", JointType::kRevolute)}));
}

TEST(SerialArmTest, JointsAreCounted) {
  std::vector<Joint> joints = {Link("0", "", JointType::kRevolute)};
  while (joints.size() < kernel::kMaxArmJoints) {
    joints.push_back(Link(std::to_string(joints.size()), joints.back().id,
                          JointType::kRevolute));
  }
  EXPECT_TRUE(IsArm(joints));
  joints.push_back(Link("more", joints.back().id, JointType::kRevolute));
  EXPECT_FALSE(IsArm(joints));
}

TEST(SerialArmTest, AnglesBeyondTheKernelsAreLeftToOthers) {
  Joint winch = Link("winch", "", JointType::kRevolute);
  winch.limits.lower = {0};
  winch.limits.upper = {8e4};
  EXPECT_TRUE(IsArm({winch}));
  winch.limits.upper = {1e6};
  EXPECT_FALSE(IsArm({winch}));
  // Lengths are of any size.
  Joint slider = winch;
  slider.type = JointType::kPrismatic;
  EXPECT_TRUE(IsArm({slider}));

  const IkProblem free =
      ProblemOf(PlanarChain({0, 0, 0}, {1, 1}),
                {PositionGoalFor("tip", Eigen::Vector3d::Zero())});
  kernel::ArmRow q = {};
  q[1] = -8e4;
  EXPECT_TRUE(free.arm()->Takes(q));
  q[1] = -1e5;
  EXPECT_FALSE(free.arm()->Takes(q));
}

TEST(SerialArmTest, OneGoalThatIsOn) {
  const auto panda = PandaArm();
  const Goal pose = PoseGoalFor("tip", {});
  EXPECT_NE(ProblemOf(panda, {pose}).arm(), nullptr);
  EXPECT_NE(
      ProblemOf(panda, {PositionGoalFor("tip", Eigen::Vector3d::Zero())}).arm(),
      nullptr);
  EXPECT_NE(
      ProblemOf(panda, {RotationGoalFor("tip", Eigen::Quaterniond::Identity())})
          .arm(),
      nullptr);
  Goal second = PositionGoalFor("j4", Eigen::Vector3d::Zero());
  EXPECT_EQ(ProblemOf(panda, {pose, second}).arm(), nullptr);
  EXPECT_EQ(ProblemOf(panda, {}).arm(), nullptr);
  IkProblem problem = ProblemOf(panda, {pose});
  problem.SetWeight(0, 0);
  EXPECT_EQ(problem.arm(), nullptr);
  problem.SetWeight(0, 3);
  EXPECT_NE(problem.arm(), nullptr);
}

Eigen::Matrix3d Matrix(const kernel::Matrix3& m) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m);
}

Eigen::Matrix3d About(const Eigen::Vector3d& axis, double cosine, double sine) {
  return Eigen::AngleAxisd(std::atan2(sine, cosine), axis).toRotationMatrix();
}

// The last joint's frame at the tip, as the header of arm_layout.h has it.
struct Frame {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d origin;
};

Frame LastFrame(const kernel::ArmLayout& arm,
                const kernel::ArmSettings& settings, const kernel::ArmRow& q) {
  Frame frame = {Matrix(settings.world_from_first_rotation),
                 Eigen::Vector3d(settings.world_from_first_translation)};
  for (int i = 0; i < arm.joint_count; ++i) {
    const double angle = arm.turn[i] * q[i] + arm.offset[i];
    frame.rotation *=
        About(Eigen::Vector3d::UnitZ(), std::cos(angle), std::sin(angle));
    const double way = (1 - arm.turn[i]) * q[i];
    frame.origin +=
        frame.rotation * Eigen::Vector3d(arm.x[i], arm.y[i], arm.z[i] + way);
    frame.rotation *=
        About(Eigen::Vector3d::UnitX(), arm.cos_twist[i], arm.sin_twist[i]);
  }
  return frame;
}

TEST(SerialArmTest, ItsFramesAreThoseOfForwardKinematics) {
  Random random(1);
  SkeletonRecipe recipe;
  recipe.types = {JointType::kRevolute, JointType::kRevolute,
                  JointType::kPrismatic, JointType::kFixed};
  recipe.branching = 0;
  recipe.mimicking = 0;
  int compared = 0;
  for (int i = 0; i < 200; ++i) {
    recipe.joint_count = 1 + UniformIndex(random, 10);
    const auto skeleton =
        i % 3 == 0 ? PandaArm() : RandomSkeleton(random, recipe);
    const Eigen::VectorXd pose = RandomPoseWithinLimits(random, *skeleton);
    const std::string tip = skeleton->end_effectors()[0].id;
    const RigidTransform world_from_skeleton = RandomTransform(random, 3);
    // A target that is met at `pose`.
    const RigidTransform world_from_tip =
        world_from_skeleton * EffectorPose(*skeleton, pose, tip);
    IkProblem problem = ProblemOf(skeleton, {PoseGoalFor(tip, world_from_tip)});
    if (problem.arm() == nullptr) continue;  // All joints fixed.
    ++compared;
    const SerialArm& arm = *problem.arm();
    kernel::Settings settings = {};
    settings.position_tolerance2 = kRounding * kRounding;
    const Eigen::Matrix3d base =
        world_from_skeleton.rotation.toRotationMatrix();
    for (int k = 0; k < 9; ++k) settings.base_rotation[k] = base(k / 3, k % 3);
    for (int k = 0; k < 3; ++k) {
      settings.base_translation[k] = world_from_skeleton.translation[k];
    }
    const std::vector<double> free(kernel::kMaxArmJoints, 0);
    settings.lower = settings.upper = free.data();
    kernel::ArmSettings arm_settings;
    kernel::ArmTarget target;
    kernel::ArmRow q;
    arm.Prepare(settings, problem.targets()[0], arm_settings);
    arm.Prepare(problem.targets()[0], target);
    arm.Gather(pose, q);
    const Frame last = LastFrame(arm.layout(), arm_settings, q);
    EXPECT_LE((last.rotation - Matrix(target.world_rotation)).norm(),
              kRounding);
    EXPECT_LE((last.origin - Eigen::Vector3d(target.world_translation)).norm(),
              kRounding);
    EXPECT_FALSE(arm.IsOutOfReach(arm_settings, target));
  }
  EXPECT_GT(compared, 180);
}

TEST(SerialArmTest, GathersAndScattersItsOwnNumbers) {
  SkeletonBuilder builder;
  builder.AddJoint(Link("root", "", JointType::kFixed))
      .AddJoint(Link("other", "root", JointType::kSpherical))
      .AddJoint(Link("a", "root", JointType::kRevolute))
      .AddJoint(Link("b", "a", JointType::kPrismatic));
  const IkProblem problem =
      ProblemOf(builder.Build().value(), {PoseGoalFor("b", {})});
  Eigen::VectorXd positions(6);
  positions << 0, 0, 0, 1, 0.5, 0.25;
  kernel::ArmRow q;
  problem.arm()->Gather(positions, q);
  EXPECT_EQ(q[0], 0.5);
  EXPECT_EQ(q[1], 0.25);
  q[1] = 0.75;
  problem.arm()->Scatter(q, positions);
  EXPECT_EQ(positions[3], 1);
  EXPECT_EQ(positions[4], 0.5);
  EXPECT_EQ(positions[5], 0.75);
}

}  // namespace
}  // namespace gelenk
