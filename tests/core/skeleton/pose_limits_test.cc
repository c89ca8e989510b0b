// ClampToLimits and LimitExcess of skeleton/pose.h.
#include <gtest/gtest.h>

#include <cmath>

#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeleton;

// Angles come back from quaternions. Where a swing is close to pi its twist is
// that much less certain, and random poses come within 1e-2 rad.
constexpr double kRounding = 1e-11;

// q = [a | u v angle | t, quaternion]: a revolute joint within [-0.5, 1], a
// planar one with a frozen v, a free one with a box, a cone and a twist range.
std::shared_ptr<const Skeleton> LimitedChain() {
  Joint arm;
  arm.id = "arm";
  arm.type = JointType::kRevolute;
  arm.limits.lower = {-0.5};
  arm.limits.upper = {1};
  Joint skid;
  skid.id = "skid";
  skid.parent_id = "arm";
  skid.type = JointType::kPlanar;
  skid.limits.lower = {-1, 0.25, -INFINITY};
  skid.limits.upper = {INFINITY, 0.25, 2};
  Joint body;
  body.id = "body";
  body.parent_id = "skid";
  body.type = JointType::kFree;
  body.axis = Eigen::Vector3d::UnitX();
  body.limits.lower = {-1, -2, -3};
  body.limits.upper = {1, 2, 3};
  body.limits.swing_cone_rad = 0.5;
  body.limits.twist_lower_rad = 3;
  body.limits.twist_upper_rad = 3.5;
  return SkeletonBuilder()
      .AddJoint(arm)
      .AddJoint(skid)
      .AddJoint(body)
      .Build()
      .value();
}

constexpr int kBody = 2;
constexpr int kBodyRotation = 7;

// Inside all limits, at some of them.
Eigen::VectorXd InsidePose() {
  Eigen::VectorXd positions = Eigen::VectorXd::Zero(11);
  positions[0] = 1;
  positions[2] = 0.25;
  positions[4] = -1;
  StoreXyzw(ExpRotation({3.25, 0, 0}), positions.data() + kBodyRotation);
  return positions;
}

TEST(PoseLimitsTest, InsideNothingMoves) {
  const auto chain = LimitedChain();
  Eigen::VectorXd positions = InsidePose();
  int joint = 7;
  EXPECT_EQ(LimitExcess(*chain, positions, &joint), 0);
  EXPECT_EQ(joint, -1);
  EXPECT_EQ(ClampToLimits(*chain, positions), 0);
  EXPECT_EQ(positions, InsidePose());
}

struct NumberCase {
  int index;  // In q.
  double value;
  double clamped;
  int joint;
};

class NumberLimitTest : public ::testing::TestWithParam<NumberCase> {};

TEST_P(NumberLimitTest, ExcessAndClamp) {
  const NumberCase& c = GetParam();
  const double excess = std::abs(c.value - c.clamped);
  const auto chain = LimitedChain();
  Eigen::VectorXd positions = InsidePose();
  positions[c.index] = c.value;
  int joint = 7;
  EXPECT_DOUBLE_EQ(LimitExcess(*chain, positions, &joint), excess);
  EXPECT_EQ(joint, excess > 0 ? c.joint : -1);
  EXPECT_DOUBLE_EQ(LimitExcess(*chain, positions, nullptr), excess);
  EXPECT_DOUBLE_EQ(ClampToLimits(*chain, positions), excess);
  Eigen::VectorXd want = InsidePose();
  want[c.index] = c.clamped;
  EXPECT_EQ(positions, want);
}

INSTANTIATE_TEST_SUITE_P(
    BothSides, NumberLimitTest,
    ::testing::Values(NumberCase{0, -0.5, -0.5, 0},
                      NumberCase{0, -0.75, -0.5, 0},
                      NumberCase{0, 1.5, 1, 0},        // Above.
                      NumberCase{1, -1.25, -1, 1},     // Half open.
                      NumberCase{1, 1e9, 1e9, 1},      //
                      NumberCase{2, 0.25, 0.25, 1},    // Frozen.
                      NumberCase{2, 0.5, 0.25, 1},     //
                      NumberCase{2, 0, 0.25, 1},       //
                      NumberCase{3, -1e9, -1e9, 1},    //
                      NumberCase{3, 2.5, 2, 1},        //
                      NumberCase{4, 1.5, 1, kBody},    // Free translations.
                      NumberCase{5, -2.5, -2, kBody},  //
                      NumberCase{6, 3.5, 3, kBody}));

TEST(PoseLimitsTest, RotationOfAFreeJoint) {
  const auto chain = LimitedChain();
  Eigen::VectorXd positions = InsidePose();
  // A twist of 2.75, and a swing of 0.6 about Y after it.
  StoreXyzw(ExpRotation({0, 0.6, 0}) * ExpRotation({2.75, 0, 0}),
            positions.data() + kBodyRotation);
  int joint = 7;
  EXPECT_NEAR(LimitExcess(*chain, positions, &joint), 0.25, kRounding);
  EXPECT_EQ(joint, kBody);
  EXPECT_NEAR(ClampToLimits(*chain, positions), 0.25, kRounding);
  EXPECT_LE(AngleBetween(QuaternionXyzw(positions.data() + kBodyRotation),
                         ExpRotation({0, 0.5, 0}) * ExpRotation({3, 0, 0})),
            kRounding);
}

TEST(PoseLimitsTest, TheWorstJointIsNamed) {
  const auto chain = LimitedChain();
  Eigen::VectorXd positions = InsidePose();
  positions[0] = 1.25;
  positions[3] = 4;
  positions[5] = 3;
  int joint = 7;
  EXPECT_EQ(LimitExcess(*chain, positions, &joint), 2);
  EXPECT_EQ(joint, 1);
}

TEST(PoseLimitsTest, ClampedPosesOfRandomTreesAreInside) {
  Random random(1);
  for (int tree = 0; tree < 300; ++tree) {
    const auto skeleton = RandomSkeleton(random);
    Eigen::VectorXd positions = RandomPose(random, *skeleton);
    const Eigen::VectorXd given = positions;
    const double excess = LimitExcess(*skeleton, positions, nullptr);
    EXPECT_NEAR(ClampToLimits(*skeleton, positions), excess, kRounding);
    EXPECT_LE(LimitExcess(*skeleton, positions, nullptr), kRounding);
    EXPECT_TRUE(CheckPositions(*skeleton, positions).ok());
    if (excess == 0) {
      EXPECT_EQ(positions, given);
    }
  }
}

TEST(PoseLimitsTest, PosesDrawnWithinLimitsStay) {
  Random random(2);
  for (int tree = 0; tree < 100; ++tree) {
    const auto skeleton = RandomSkeleton(random);
    Eigen::VectorXd positions = RandomPoseWithinLimits(random, *skeleton);
    EXPECT_LE(LimitExcess(*skeleton, positions, nullptr), kRounding);
    EXPECT_LE(ClampToLimits(*skeleton, positions), kRounding);
  }
}

}  // namespace
}  // namespace gelenk
