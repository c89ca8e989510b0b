#include "gelenk/skin/muscle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gelenk/math/rotation.h"
#include "gelenk/skin/volume_rig.h"
#include "tests/core/skin/skin_chains.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::BallChain;
using ::gelenk::testing::BentPose;
using ::gelenk::testing::ElbowAt;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomLengths;
using ::gelenk::testing::TwoLinkArm;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kRounding = 1e-12;

double LinkVolume(const VolumeRig& rig, const VolumeFrame& frame, int link) {
  return frame.volume(rig.volume(link, VolumePart::kFirstHalf))
             .VolumePerSection() +
         frame.volume(rig.volume(link, VolumePart::kSecondHalf))
             .VolumePerSection();
}

Muscle Biceps() {
  Muscle biceps;
  biceps.id = "biceps";
  biceps.link_id = "upper";
  biceps.driver_joint_id = "lower";
  biceps.gain_s = 0.5;
  biceps.gain_t = 0.25;
  biceps.pivot_m = {-0.1, 0};
  return biceps;
}

Muscle VolumeKeeper(const std::string& link) {
  Muscle keeper;
  keeper.id = link + " volume";
  keeper.link_id = link;
  keeper.mode = MuscleMode::kPreserveVolume;
  return keeper;
}

TEST(MuscleTest, SwellsWithTheFlexionOfItsDriver) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  const auto rig = VolumeRig::Create(arm, {}, {{Biceps()}, {}}).value();
  VolumeFrame frame;
  for (double angle : {0.0, 60.0, 90.0, 180.0}) {
    rig->Evaluate(ElbowAt(*arm, angle * kDegree), {}, frame);
    const double effort = 0.5 * (1 - std::cos(angle * kDegree));
    for (int plane : {2, 3, 4}) {
      const ControlPlane& inner = frame.planes(0)[plane];
      EXPECT_NEAR(inner.s_axis().norm(), 1 + 0.5 * effort, kRounding);
      EXPECT_NEAR(inner.t_axis().norm(), 1 + 0.25 * effort, kRounding);
      // The pivot stays where it is: the bulge is on one side.
      EXPECT_NEAR(inner(-0.1, 0).y(), -0.1, kRounding);
      EXPECT_NEAR(inner(0.1, 0).y(), 0.1 + 0.2 * 0.5 * effort, kRounding);
    }
  }
}

TEST(MuscleTest, BallJointDrivesByItsWholeTurn) {
  Random random(1);
  const auto skeleton = BallChain(random, {1, 1});
  Muscle muscle = Biceps();
  muscle.link_id = "j0";
  muscle.driver_joint_id = "j1";
  const auto rig = VolumeRig::Create(skeleton, {}, {{muscle}, {}}).value();
  Eigen::VectorXd pose = NeutralPositions(*skeleton);
  VolumeFrame frame;
  for (double sign : {1.0, -1.0}) {
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(sign, testing::RandomDirection(random)));
    StoreXyzw(turn, pose.data() + 4);
    rig->Evaluate(pose, {}, frame);
    EXPECT_NEAR(frame.planes(0)[3].s_axis().norm(),
                1 + 0.25 * (1 - std::cos(1.0)), kRounding);
  }
}

TEST(MuscleTest, RestPoseIsAtEaseHoweverBent) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  SkinLinkOptions options;
  options.rest_positions = ElbowAt(*arm, 0.7);
  const auto rig = VolumeRig::Create(arm, options, {{Biceps()}, {}}).value();
  VolumeFrame frame;
  rig->Evaluate(options.rest_positions, {}, frame);
  for (int i = 0; i < rig->volume_count(); ++i) {
    EXPECT_EQ(frame.volume(i).coefficient(3),
              rig->rest().volume(i).coefficient(3));
  }
}

TEST(MuscleTest, MusclesOfOneLinkActInTurn) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  Muscle triceps = Biceps();
  triceps.id = "triceps";
  triceps.gain_s = -0.2;
  triceps.pivot_m = {0.1, 0};
  const auto rig =
      VolumeRig::Create(arm, {}, {{Biceps(), triceps}, {}}).value();
  VolumeFrame frame;
  rig->Evaluate(ElbowAt(*arm, 90 * kDegree), {}, frame);
  const double first = 1.25, second = 0.9;
  const auto moved = [&](double s) {
    s = -0.1 + first * (s + 0.1);
    return 0.1 + second * (s - 0.1);
  };
  for (double s : {-0.2, 0.0, 0.15}) {
    EXPECT_NEAR(frame.planes(0)[2](s, 0).y(), moved(s), kRounding);
  }
}

TEST(MuscleTest, ExplicitScalesAreThosePlanes) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  Muscle muscle = Biceps();
  muscle.mode = MuscleMode::kExplicit;
  muscle.scale_s = {1.2, 1.4};
  muscle.scale_t = {0.8, 1};
  const auto rig = VolumeRig::Create(arm, {}, {{muscle}, {}}).value();
  VolumeFrame frame;
  rig->Evaluate(rig->rest_positions(), {}, frame);
  EXPECT_NEAR(frame.planes(0)[2].s_axis().norm(), 1.2, kRounding);
  EXPECT_NEAR(frame.planes(0)[4].s_axis().norm(), 1.4, kRounding);
  EXPECT_NEAR(frame.planes(0)[3].s_axis().norm(), 1.3, kRounding);
  EXPECT_NEAR(frame.planes(0)[2].t_axis().norm(), 0.8, kRounding);
  // What is bound is bound to the limb at ease.
  EXPECT_NEAR(rig->rest().planes(0)[2].s_axis().norm(), 1, kRounding);
}

TEST(MuscleTest, PreservedVolumeIsThatOfTheRest) {
  Random random(2);
  for (int chain = 0; chain < 500; ++chain) {
    const auto skeleton = BallChain(random, RandomLengths(random, 5), 0.5);
    SkinMuscles muscles;
    for (const Joint& joint : skeleton->joints()) {
      muscles.muscles.push_back(VolumeKeeper(joint.id));
    }
    const auto rig = VolumeRig::Create(skeleton, {}, muscles).value();
    VolumeFrame frame;
    rig->Evaluate(BentPose(random, *skeleton, 2.8), {}, frame);
    for (int i = 0; i < rig->link_count(); ++i) {
      const double want = LinkVolume(*rig, rig->rest(), i);
      const double got = LinkVolume(*rig, frame, i);
      EXPECT_NEAR(got / want, 1, 1e-13);
      EXPECT_EQ(frame.volume_scale(i), frame.wanted_volume_scale(i));
    }
  }
}

TEST(MuscleTest, VolumeOutOfReachIsClampedAndReported) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  Muscle swollen = Biceps();
  swollen.mode = MuscleMode::kExplicit;
  VolumeFrame frame;
  for (double scale : {0.5, 2.0}) {
    swollen.scale_s = swollen.scale_t = {scale, scale};
    const auto rig =
        VolumeRig::Create(arm, {}, {{swollen, VolumeKeeper("upper")}, {}})
            .value();
    rig->Evaluate(ElbowAt(*arm, 1), {}, frame);
    EXPECT_EQ(frame.volume_scale(0), scale > 1 ? 0.8 : 1.35);
    // What would have been needed undoes the swelling.
    EXPECT_NEAR(frame.wanted_volume_scale(0), 1 / scale, 0.1 / scale);
    EXPECT_EQ(LinkVolume(*rig, frame, 0) > 1, scale > 1);
  }
}

TEST(MuscleTest, VolumeIsPreservedBesideABulge) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  const auto rig =
      VolumeRig::Create(arm, {}, {{Biceps(), VolumeKeeper("upper")}, {}})
          .value();
  VolumeFrame frame;
  rig->Evaluate(ElbowAt(*arm, 90 * kDegree), {}, frame);
  EXPECT_NEAR(LinkVolume(*rig, frame, 0), 1, 1e-13);
  EXPECT_EQ(frame.volume_scale(1), 1);
}

TEST(MuscleTest, MitreKeepsTheBoreOfTheBend) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  VolumeFrame frame;
  for (double fullness : {0.0, 0.5, 1.0}) {
    const auto rig =
        VolumeRig::Create(arm, {}, {{}, {{"lower", fullness}}}).value();
    rig->Evaluate(ElbowAt(*arm, 90 * kDegree), {}, frame);
    const double want = 1 + fullness * (std::sqrt(2) - 1);
    for (const ControlPlane& plane :
         {frame.planes(0)[5], frame.planes(0)[6], frame.planes(1)[1]}) {
      EXPECT_NEAR(plane.s_axis().norm(), want, kRounding);
      EXPECT_NEAR(plane.t_axis().norm(), 1, kRounding);
    }
  }
}

TEST(MuscleTest, MitreIsNoneInAStraightJointAndBoundedInAFoldedOne) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  const auto rig = VolumeRig::Create(arm, {}, {{}, {{"lower", 1}}}).value();
  VolumeFrame frame;
  rig->Evaluate(ElbowAt(*arm, 0), {}, frame);
  EXPECT_NEAR(frame.planes(0)[6].s_axis().norm(), 1, kRounding);
  for (double angle : {119.0, 121.0, 180.0}) {
    rig->Evaluate(ElbowAt(*arm, angle * kDegree), {}, frame);
    EXPECT_NEAR(frame.planes(0)[6].s_axis().norm(),
                angle < 120 ? 1 / std::cos(0.5 * angle * kDegree) : 2,
                kRounding);
  }
}

// The thickest limb that bends by 90 degrees without a fold, by FindFolds and
// by looking at determinants.
TEST(MuscleTest, FoldIsFoundOnBothSidesOfItsLimit) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  VolumeFrame frame;
  const auto folds = [&](double radius_m) {
    SkinLinkOptions options;
    options.slenderness = radius_m;
    const auto rig = VolumeRig::Create(arm, options).value();
    rig->Evaluate(ElbowAt(*arm, 90 * kDegree), {}, frame);
    return rig->FindFolds(frame);
  };
  double low = 0.05, high = 1;
  for (int step = 0; step < 30; ++step) {
    const double middle = 0.5 * (low + high);
    (folds(middle).empty() ? low : high) = middle;
  }
  // The control polygon of the inside runs forwards below this: enough, but
  // not needed.
  EXPECT_GT(low, (2 - std::cos(45 * kDegree)) / std::sin(45 * kDegree) / 6);
  const std::vector<VolumeFold> found = folds(high + 0.01);
  ASSERT_EQ(found.size(), 2);
  const auto least = [&](double radius_m) {
    double least = 1;
    for (int i = 0; i <= 1000; ++i) {
      least = std::min(least, frame.volume(found[0].volume)
                                  .Evaluate({i / 1000.0, radius_m, 0})
                                  .Jacobian()
                                  .determinant());
    }
    return least;
  };
  // 33 samples of u miss the limit by little.
  EXPECT_GT(least(low - 1e-3), 0);
  EXPECT_LT(least(low + 1e-3), 0);
  EXPECT_LT(found[0].least_jacobian, 0);
}

TEST(MuscleTest, ListsEverythingThatIsWrong) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  SkinMuscles muscles;
  Muscle bad = Biceps();
  bad.id = "";
  bad.link_id = "tail";
  bad.driver_joint_id = "nose";
  bad.gain_s = std::nan("");
  Muscle keeper = VolumeKeeper("upper");
  keeper.min_scale = 2;
  keeper.max_scale = 1;
  keeper.pivot_m = {0.1, 0};
  Muscle again = VolumeKeeper("upper");
  again.id = keeper.id;
  muscles.muscles = {bad, keeper, again};
  muscles.fullness = {{"upper", 0.5}, {"lower", 1.5}};
  EXPECT_THAT(
      ViolationLines(VolumeRig::Create(arm, {}, muscles).status()),
      ElementsAre(
          "muscles[0].muscle_id: want 1 to 63 bytes, got 0",
          "muscles[0].link_id: no link \"tail\"",
          "muscles[0].gain: want a number in (-1, 10], got nan",
          "muscles[0].driver_joint_id: no joint \"nose\"",
          "muscles[1].min_scale: 2 > max_scale 1", HasSubstr("[1].pivot"),
          HasSubstr("muscles[2].muscle_id: \"upper volume\" is there twice"),
          HasSubstr("muscles[2].link_id: \"upper\" preserves"),
          HasSubstr("fullness[0].link_id: \"upper\" is the root"),
          "fullness[1].fullness: want 0 to 1, got 1.5"));
}

TEST(MuscleTest, OtherMusclesLeaveTheRigAlone) {
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  const auto rig = VolumeRig::Create(arm).value();
  const auto strong = rig->WithMuscles({{Biceps()}, {}}).value();
  VolumeFrame frame;
  strong->Evaluate(ElbowAt(*arm, 2), {}, frame);
  EXPECT_GT(frame.planes(0)[3].s_axis().norm(), 1.1);
  rig->Evaluate(ElbowAt(*arm, 2), {}, frame);
  EXPECT_NEAR(frame.planes(0)[3].s_axis().norm(), 1, kRounding);
  EXPECT_FALSE(rig->WithMuscles({{Muscle{}}, {}}).ok());
}

}  // namespace
}  // namespace gelenk
