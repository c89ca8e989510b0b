#include "gelenk/skin/volume_rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "gelenk/math/rotation.h"
#include "gelenk/skin/example_shapes.h"
#include "tests/core/skin/skin_chains.h"
#include "tests/testing/example_bodies.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using ::gelenk::testing::BallChain;
using ::gelenk::testing::BentPose;
using ::gelenk::testing::ElbowAt;
using ::gelenk::testing::PelvisWithLeg;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomLengths;
using ::gelenk::testing::RandomMuscles;
using ::gelenk::testing::RandomTransform;
using ::gelenk::testing::TwoLinkArm;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
constexpr double kRounding = 1e-12;
// A deformation gradient divides by the rest's Jacobian.
constexpr double kGradientRounding = 1e-10;

// Volumes of a chain from its root to its end.
std::vector<int> ChainVolumes(const VolumeRig& rig) {
  std::vector<int> volumes;
  for (int i = 0; i < rig.link_count(); ++i) {
    volumes.push_back(rig.volume(i, VolumePart::kFirstHalf));
    volumes.push_back(rig.volume(i, VolumePart::kSecondHalf));
  }
  return volumes;
}

// At (s, t) of the plane between the ends of two volumes.
struct Jump {
  double position;
  double derivative;
};
Jump JumpBetween(const BezierVolume& before, const BezierVolume& after,
                 double s, double t) {
  const VolumePoint end = before.Evaluate({1, s, t});
  const VolumePoint start = after.Evaluate({0, s, t});
  return {(end.position - start.position).norm(),
          (end.Jacobian() - start.Jacobian()).norm()};
}

TEST(VolumeRigTest, NeighboursMeetSmoothlyInAnyBend) {
  Random random(1);
  int interfaces = 0;
  for (int chain = 0; chain < 400; ++chain) {
    const auto skeleton =
        BallChain(random, RandomLengths(random, 5), chain % 2 ? 1.2 : 0);
    const auto rig =
        VolumeRig::Create(skeleton, {}, RandomMuscles(random, *skeleton))
            .value();
    ASSERT_EQ(rig->link_count(), 5);
    VolumeFrame frame;
    rig->Evaluate(BentPose(random, *skeleton, 160 * kDegree), {}, frame);
    const std::vector<int> volumes = ChainVolumes(*rig);
    for (size_t k = 0; k + 1 < volumes.size(); ++k, ++interfaces) {
      const double s = Uniform(random, -0.3, 0.3);
      const double t = Uniform(random, -0.3, 0.3);
      const BezierVolume& before = frame.volume(volumes[k]);
      const BezierVolume& after = frame.volume(volumes[k + 1]);
      const Jump jump = JumpBetween(before, after, s, t);
      EXPECT_LE(jump.position, kRounding);
      EXPECT_LE(jump.derivative, kRounding);
      const Matrix3d rest_before =
          rig->rest().volume(volumes[k]).Evaluate({1, s, t}).Jacobian();
      const Matrix3d rest_after =
          rig->rest().volume(volumes[k + 1]).Evaluate({0, s, t}).Jacobian();
      if (std::abs(rest_before.determinant()) < 1e-3) continue;
      EXPECT_LE((before.Evaluate({1, s, t}).Jacobian() * rest_before.inverse() -
                 after.Evaluate({0, s, t}).Jacobian() * rest_after.inverse())
                    .norm(),
                kGradientRounding);
    }
  }
  EXPECT_EQ(interfaces, 3600);
}

// What the test above would say if P5 did not turn with the joint.
TEST(VolumeRigTest, PlaneLeftUnturnedIsAVisibleCrease) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  const auto rig = VolumeRig::Create(arm).value();
  VolumeFrame frame;
  rig->Evaluate(ElbowAt(*arm, 90 * kDegree), {}, frame);
  std::vector<ControlPlane> planes(frame.planes(0).begin() + 3,
                                   frame.planes(0).end());
  planes[2] =
      ControlPlane({5.0 / 6, 0, 0}, Vector3d::UnitY(), Vector3d::UnitZ());
  EXPECT_GT(
      JumpBetween(BezierVolume::Between(planes),
                  frame.volume(rig->volume(1, VolumePart::kFirstHalf)), 0.2, 0)
          .derivative,
      0.1);
}

TEST(VolumeRigTest, RigidMotionOfTheRigMovesTheSkinRigidly) {
  Random random(2);
  for (int chain = 0; chain < 100; ++chain) {
    const auto skeleton = BallChain(random, RandomLengths(random, 4), 0.8);
    const auto rig =
        VolumeRig::Create(skeleton, {}, RandomMuscles(random, *skeleton))
            .value();
    const Eigen::VectorXd pose = BentPose(random, *skeleton, 2);
    const RigidTransform motion = RandomTransform(random, 1);
    VolumeFrame still, moved;
    rig->Evaluate(pose, {}, still);
    rig->Evaluate(pose, motion, moved);
    for (int i = 0; i < rig->volume_count(); ++i) {
      const VolumeCoordinates at = {Uniform(random, 0, 1),
                                    Uniform(random, -0.3, 0.3),
                                    Uniform(random, -0.3, 0.3)};
      // Chains of 8 m: 1e-13 of that.
      EXPECT_LE(
          (moved.volume(i).Position(at) - motion * still.volume(i).Position(at))
              .norm(),
          8e-13);
    }
  }
}

TEST(VolumeRigTest, PlanesAreWhereTheLinksAre) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  const auto rig = VolumeRig::Create(arm).value();
  ASSERT_EQ(rig->link_count(), 2);
  EXPECT_EQ(rig->link(0).continuation, 1);
  EXPECT_EQ(rig->chain(0), rig->chain(1));
  const double x[] = {0, 1 / 6.0, 1 / 3.0, 1 / 2.0, 2 / 3.0, 5 / 6.0, 1};
  for (int link = 0; link < 2; ++link) {
    for (int k = 0; k < kPlanesPerLink; ++k) {
      const ControlPlane& plane = rig->rest().planes(link)[k];
      EXPECT_LE((plane.center() - Vector3d(link + x[k], 0, 0)).norm(),
                kRounding);
      EXPECT_LE((plane.s_axis() - Vector3d::UnitY()).norm(), kRounding);
      EXPECT_LE((plane.t_axis() - Vector3d::UnitZ()).norm(), kRounding);
    }
  }
}

TEST(VolumeRigTest, SpacingIsASixthOfTheShorterLink) {
  Random random(3);
  const auto skeleton = BallChain(random, {1.2, 0.6, 1.8});
  const auto rig = VolumeRig::Create(skeleton).value();
  EXPECT_NEAR(rig->start_spacing_m(0), 0.2, kRounding);
  EXPECT_NEAR(rig->end_spacing_m(0), 0.1, kRounding);
  EXPECT_NEAR(rig->start_spacing_m(1), 0.1, kRounding);
  EXPECT_NEAR(rig->end_spacing_m(1), 0.1, kRounding);
  EXPECT_NEAR(rig->end_spacing_m(2), 0.3, kRounding);
  // {0, d0, L/2 - m, L/2, L/2 + m, L - d6, L}, m = (L - d0 - d6) / 4.
  const auto planes = rig->rest().planes(0);
  EXPECT_NEAR(planes[2].center().x(), 0.6 - 0.225, kRounding);
  EXPECT_NEAR(planes[5].center().x(), 1.1, kRounding);
}

TEST(VolumeRigTest, SharedPlaneIsTheMiddleOfItsNeighbours) {
  Random random(4);
  const auto skeleton = BallChain(random, RandomLengths(random, 3), 0.5);
  const auto rig = VolumeRig::Create(skeleton).value();
  VolumeFrame frame;
  rig->Evaluate(BentPose(random, *skeleton, 2), {}, frame);
  for (int i = 0; i < 2; ++i) {
    const auto before = frame.planes(i);
    const auto after = frame.planes(i + 1);
    EXPECT_EQ(before[6].columns, after[0].columns);
    EXPECT_LE((before[6].columns - 0.5 * (before[5].columns + after[1].columns))
                  .norm(),
              kRounding);
  }
}

TEST(VolumeRigTest, CapsContinueTheEnds) {
  Random random(5);
  const auto skeleton = BallChain(random, RandomLengths(random, 3), 0.5);
  const auto rig = VolumeRig::Create(skeleton).value();
  VolumeFrame frame;
  rig->Evaluate(BentPose(random, *skeleton, 2), {}, frame);
  // Beyond the tip F(1) + x F'(1) / |F'(1)|; before the root likewise.
  const BezierVolume& last =
      frame.volume(rig->volume(2, VolumePart::kSecondHalf));
  const BezierVolume& first =
      frame.volume(rig->volume(0, VolumePart::kFirstHalf));
  const double length = rig->link(2).length_m;
  const double s = 0.1, t = -0.2, beyond = 0.15;
  const VolumePoint end = last.Evaluate({1, s, t});
  EXPECT_LE((frame.volume(rig->volume(2, VolumePart::kRigid))
                 .Position({1 + beyond / length, s, t}) -
             (end.position + beyond * end.along_u.normalized()))
                .norm(),
            kRounding);
  const VolumePoint start = first.Evaluate({0, s, t});
  EXPECT_LE((frame.volume(rig->volume(0, VolumePart::kRigid))
                 .Position({-beyond / rig->link(0).length_m, s, t}) -
             (start.position - beyond * start.along_u.normalized()))
                .norm(),
            kRounding);
}

TEST(VolumeRigTest, TwistedRingHasTheRadiusOfAQuarterOfTheTwist) {
  const auto arm = TwoLinkArm(Vector3d::UnitX());
  const auto rig = VolumeRig::Create(arm).value();
  VolumeFrame frame;
  for (double twist : {0.3, 1.0, 2.0, kPi, 4.0}) {
    rig->Evaluate(ElbowAt(*arm, twist), {}, frame);
    const ControlPlane middle =
        frame.volume(rig->volume(0, VolumePart::kSecondHalf)).At(0.5);
    EXPECT_NEAR(middle.s_axis().norm(), std::cos(twist / 4), kRounding);
    EXPECT_NEAR(middle.t_axis().norm(), std::cos(twist / 4), kRounding);
  }
}

TEST(VolumeRigTest, BranchMeetsItsStubSmoothly) {
  Random random(6);
  const auto skeleton = PelvisWithLeg();
  const auto rig = VolumeRig::Create(skeleton).value();
  const int thigh = rig->FindLink("thigh");
  ASSERT_TRUE(rig->is_branch(thigh));
  EXPECT_NE(rig->chain(thigh), rig->chain(rig->FindLink("pelvis")));
  EXPECT_EQ(rig->chain(thigh), rig->chain(rig->FindLink("shank")));
  EXPECT_EQ(rig->link(rig->FindLink("pelvis")).continuation,
            rig->FindLink("spine"));
  VolumeFrame frame;
  for (int pose = 0; pose < 100; ++pose) {
    rig->Evaluate(BentPose(random, *skeleton, 2), {}, frame);
    const BezierVolume& stub =
        frame.volume(rig->volume(thigh, VolumePart::kStub));
    const Jump jump = JumpBetween(
        stub, frame.volume(rig->volume(thigh, VolumePart::kFirstHalf)),
        Uniform(random, -0.2, 0.2), Uniform(random, -0.2, 0.2));
    EXPECT_LE(jump.position, kRounding);
    EXPECT_LE(jump.derivative, kRounding);
    // The other end is rigid with the parent.
    const int pelvis = rig->FindLink("pelvis");
    const Matrix3d turn =
        frame.rotation(pelvis) * rig->rest().rotation(pelvis).transpose();
    EXPECT_LE((stub.Evaluate({0, 0.1, 0.1}).Jacobian() -
               turn * rig->rest()
                          .volume(rig->volume(thigh, VolumePart::kStub))
                          .Evaluate({0, 0.1, 0.1})
                          .Jacobian())
                  .norm(),
              kRounding);
  }
}

// Whichever way a branch points at rest, its stub is straight and as even as
// the link that it leads to.
TEST(VolumeRigTest, BranchIsStraightAtRest) {
  for (absl::string_view name : SkinShapeNames()) {
    const SkinShape shape = MakeSkinShape(name, 100).value();
    const auto rig = VolumeRig::Create(shape.skeleton, shape.links).value();
    EXPECT_TRUE(rig->FindFolds(rig->rest()).empty()) << name;
    for (int i = 0; i < rig->link_count(); ++i) {
      if (!rig->is_branch(i)) continue;
      const BezierVolume& stub =
          rig->rest().volume(rig->volume(i, VolumePart::kStub));
      const Matrix3d jacobian = stub.Evaluate({0.5, 0, 0}).Jacobian();
      const Matrix3d& frame = rig->rest().rotation(i);
      EXPECT_LE(
          (jacobian.col(0) - 3 * rig->start_spacing_m(i) * frame.col(0)).norm(),
          kRounding);
      EXPECT_LE((jacobian.rightCols<2>() - frame.rightCols<2>()).norm(),
                kRounding);
    }
  }
}

TEST(VolumeRigTest, VolumesKnowTheirLinks) {
  const auto rig = VolumeRig::Create(PelvisWithLeg()).value();
  int stubs = 0;
  for (int i = 0; i < rig->volume_count(); ++i) {
    EXPECT_EQ(rig->volume(rig->volume_link(i), rig->volume_part(i)), i);
    if (rig->volume_part(i) == VolumePart::kStub) ++stubs;
  }
  EXPECT_EQ(stubs, 1);
}

TEST(VolumeRigTest, EveryKindOfSkeletonIsSmoothOrRefused) {
  Random random(7);
  int rigs = 0;
  for (int tree = 0; tree < 100; ++tree) {
    testing::SkeletonRecipe recipe;
    recipe.joint_count = 1 + testing::UniformIndex(random, 30);
    const auto skeleton = testing::RandomSkeleton(random, recipe);
    const auto rig = VolumeRig::Create(skeleton);
    if (!rig.ok()) continue;
    ++rigs;
    VolumeFrame frame;
    (*rig)->Evaluate(testing::RandomPose(random, *skeleton), {}, frame);
    for (int i = 0; i < (*rig)->link_count(); ++i) {
      EXPECT_LE(std::abs((frame.rotation(i).transpose() * frame.rotation(i) -
                          Matrix3d::Identity())
                             .norm()),
                kRounding);
      const int next = (*rig)->link(i).continuation;
      if (next < 0) continue;
      EXPECT_EQ((*rig)->link(next).parent, i);
      const Jump jump = JumpBetween(
          frame.volume((*rig)->volume(i, VolumePart::kSecondHalf)),
          frame.volume((*rig)->volume(next, VolumePart::kFirstHalf)), 0.1, 0.1);
      EXPECT_LE(jump.derivative, kRounding);
    }
  }
  EXPECT_GT(rigs, 90);
}

// The joints of an Euler joint lie in one place and carry one link.
TEST(VolumeRigTest, JointsInOnePlaceCarryOneLink) {
  SkeletonBuilder builder;
  std::string parent;
  for (const char* id : {"x0", "y0", "z0", "x1", "y1", "z1"}) {
    Joint joint;
    joint.id = id;
    joint.parent_id = parent;
    joint.type = JointType::kRevolute;
    joint.axis = Vector3d::Unit(id[0] - 'x');
    if (joint.id == "x1") joint.parent_from_joint.translation.y() = -0.4;
    builder.AddJoint(joint);
    parent = id;
  }
  builder.AddEndEffector(
      {"tip", "z1", {Eigen::Quaterniond::Identity(), Vector3d(0, -0.3, 0)}});
  const auto skeleton = builder.Build().value();
  const auto rig = VolumeRig::Create(skeleton).value();
  ASSERT_EQ(rig->link_count(), 2);
  EXPECT_EQ(rig->link(0).id, "z0");
  EXPECT_NEAR(rig->link(0).length_m, 0.4, kRounding);
  EXPECT_EQ(rig->link(1).id, "z1");
  EXPECT_NEAR(rig->link(1).length_m, 0.3, kRounding);
  EXPECT_EQ(rig->link(0).continuation, 1);
}

TEST(VolumeRigTest, BodyOfAPersonHasLinksForAllThatMoves) {
  const auto person = testing::PersonWithFingers();
  const auto rig = VolumeRig::Create(person).value();
  EXPECT_GT(rig->link_count(), 50);
  EXPECT_LE(rig->link_count(), person->joint_count());
}

TEST(VolumeRigTest, OverridesDecide) {
  SkinLinkOptions options;
  SkinLinkOverride& pelvis = options.overrides.emplace_back();
  pelvis.joint_id = "pelvis";
  pelvis.continuation_joint_id = "thigh";
  pelvis.half_extents_m = {0.3, 0.25};
  SkinLinkOverride& neck = options.overrides.emplace_back();
  neck.joint_id = "neck";
  neck.omit = true;
  SkinLinkOverride& shank = options.overrides.emplace_back();
  shank.joint_id = "shank";
  shank.length_m = 0.9;
  shank.s_direction = Vector3d::UnitZ();
  const auto rig = VolumeRig::Create(PelvisWithLeg(), options).value();
  const int link = rig->FindLink("pelvis");
  EXPECT_EQ(rig->link(link).continuation, rig->FindLink("thigh"));
  EXPECT_TRUE(rig->is_branch(rig->FindLink("spine")));
  EXPECT_EQ(rig->link(link).half_extents_m, Eigen::Vector2d(0.3, 0.25));
  EXPECT_EQ(rig->FindLink("neck"), -1);
  EXPECT_NEAR(rig->link(rig->FindLink("shank")).length_m, 0.9, kRounding);
  EXPECT_LE(
      (rig->rest().rotation(rig->FindLink("shank")).col(1) - Vector3d::UnitZ())
          .norm(),
      kRounding);
}

TEST(VolumeRigTest, ListsEveryBadOverride) {
  SkinLinkOptions options;
  options.slenderness = 0;
  SkinLinkOverride bad;
  bad.joint_id = "tail";
  bad.length_m = -1;
  bad.direction = Vector3d::Zero();
  bad.half_extents_m = {1, std::nan("")};
  options.overrides = {bad};
  EXPECT_THAT(
      ViolationLines(VolumeRig::Create(PelvisWithLeg(), options).status()),
      ElementsAre(HasSubstr("slenderness: want a number in (0, 10], got 0"),
                  HasSubstr("overrides[0].joint_id: no joint \"tail\""),
                  HasSubstr("overrides[0].length_m: want >"),
                  HasSubstr("overrides[0].direction: want a finite"),
                  HasSubstr("overrides[0].half_extents_m: want two")));
}

TEST(VolumeRigTest, SkeletonWithoutLinksIsRefused) {
  Joint root;
  root.id = "root";
  const auto skeleton = SkeletonBuilder().AddJoint(root).Build().value();
  EXPECT_FALSE(VolumeRig::Create(skeleton).ok());
}

}  // namespace
}  // namespace gelenk
