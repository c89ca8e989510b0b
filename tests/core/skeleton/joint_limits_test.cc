#include "gelenk/skeleton/joint_limits.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gelenk/math/rotation.h"
#include "tests/testing/random.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::RandomDirection;
using ::gelenk::testing::RandomRotation;
using ::gelenk::testing::Uniform;

// Angles come back from quaternions; the swings here stay 0.01 rad away from
// pi, where the twist is undefined.
constexpr double kRounding = 1e-12;

const Eigen::Vector3d kAxis(0.48, 0.6, 0.64);

Eigen::Quaterniond Rotation(double swing_rad, double twist_rad) {
  SwingTwist parts;
  parts.swing_rad = swing_rad;
  parts.swing_axis = kAxis.unitOrthogonal();
  parts.twist_rad = twist_rad;
  return ComposeSwingTwist(parts, kAxis);
}

JointLimits Cone(double swing_rad) {
  JointLimits limits;
  limits.swing_cone_rad = swing_rad;
  return limits;
}

JointLimits Twist(double lower_rad, double upper_rad) {
  JointLimits limits;
  limits.twist_lower_rad = lower_rad;
  limits.twist_upper_rad = upper_rad;
  return limits;
}

double Excess(const JointLimits& limits, const Eigen::Quaterniond& rotation) {
  return RotationLimitExcess(limits, kAxis, rotation);
}

TEST(RotationLimitTest, WithoutLimitsEverythingIsInside) {
  Random random(1);
  const Eigen::Quaterniond q = RandomRotation(random);
  EXPECT_EQ(Excess({}, q), 0);
  EXPECT_EQ(ClampRotation({}, kAxis, q).coeffs(), q.coeffs());
}

TEST(RotationLimitTest, ConeFromBothSides) {
  for (double twist : {-3.0, 0.0, 2.0}) {
    EXPECT_EQ(Excess(Cone(0.5), Rotation(0.5 - 1e-9, twist)), 0);
    EXPECT_NEAR(Excess(Cone(0.5), Rotation(0.5 + 1e-9, twist)), 1e-9,
                kRounding);
    EXPECT_NEAR(Excess(Cone(0.5), Rotation(2, twist)), 1.5, kRounding);
  }
}

TEST(RotationLimitTest, ConeOfZeroLeavesTheTwist) {
  EXPECT_NEAR(Excess(Cone(0), Rotation(0, 2)), 0, kRounding);
  EXPECT_NEAR(Excess(Cone(0), Rotation(0.25, 2)), 0.25, kRounding);
  const SwingTwist clamped = DecomposeSwingTwist(
      ClampRotation(Cone(0), kAxis, Rotation(0.25, 2)), kAxis);
  EXPECT_NEAR(clamped.swing_rad, 0, kRounding);
  EXPECT_NEAR(clamped.twist_rad, 2, kRounding);
}

struct TwistCase {
  double lower_rad;
  double upper_rad;
  double twist_rad;
  double excess_rad;
  double clamped_rad;  // Within (-pi, pi].
};

class TwistLimitTest : public ::testing::TestWithParam<TwistCase> {};

TEST_P(TwistLimitTest, ExcessAndClamp) {
  const TwistCase& c = GetParam();
  const JointLimits limits = Twist(c.lower_rad, c.upper_rad);
  for (double swing : {0.0, 0.7, M_PI - 0.01}) {
    const Eigen::Quaterniond rotation = Rotation(swing, c.twist_rad);
    EXPECT_NEAR(Excess(limits, rotation), c.excess_rad, kRounding) << swing;
    const Eigen::Quaterniond clamped = ClampRotation(limits, kAxis, rotation);
    EXPECT_LE(AngleBetween(clamped, Rotation(swing, c.clamped_rad)), kRounding)
        << swing;
    EXPECT_GE(clamped.dot(rotation), 0);
  }
}

constexpr double kPi = M_PI;

INSTANTIATE_TEST_SUITE_P(
    AroundZero, TwistLimitTest,
    ::testing::Values(TwistCase{-0.5, 1, 0.3, 0, 0.3},
                      TwistCase{-0.5, 1, -0.5 + 1e-9, 0, -0.5 + 1e-9},
                      TwistCase{-0.5, 1, -0.5 - 1e-9, 1e-9, -0.5},
                      TwistCase{-0.5, 1, 1 - 1e-9, 0, 1 - 1e-9},
                      TwistCase{-0.5, 1, 1 + 1e-9, 1e-9, 1},
                      TwistCase{-0.5, 1, -2, 1.5, -0.5},
                      TwistCase{-0.5, 1, 3, 2, 1},
                      // Nearer from the other side of the turn.
                      TwistCase{-3, 1, 3, 2 * kPi - 6, -3}));

INSTANTIATE_TEST_SUITE_P(
    AcrossPi, TwistLimitTest,
    ::testing::Values(TwistCase{3, 3.5, 3.1, 0, 3.1},
                      TwistCase{3, 3.5, kPi, 0, kPi},
                      // -3 is 3.28 a turn on.
                      TwistCase{3, 3.5, -3, 0, -3},
                      TwistCase{3, 3.5, -2.5, 2 * kPi - 6, 3.5 - 2 * kPi},
                      TwistCase{3, 3.5, 2.75, 0.25, 3},
                      TwistCase{-3.5, -3, 3, 0, 3},
                      TwistCase{-3.5, -3, -2.75, 0.25, -3},
                      TwistCase{-3.5, -3, 2.5, 2 * kPi - 6, 2 * kPi - 3.5}));

INSTANTIATE_TEST_SUITE_P(
    ATurnAway, TwistLimitTest,
    ::testing::Values(TwistCase{6, 2 * kPi, -0.2, 0, -0.2},
                      TwistCase{6, 2 * kPi, -0.5, 6.5 - 2 * kPi, 6 - 2 * kPi},
                      TwistCase{6, 2 * kPi, 0.25, 0.25, 0},
                      TwistCase{-2 * kPi, -6, 0.2, 0, 0.2},
                      TwistCase{-2 * kPi, -6, 0.5, 6.5 - 2 * kPi,
                                2 * kPi - 6}));

INSTANTIATE_TEST_SUITE_P(WholeTurnOrMore, TwistLimitTest,
                         ::testing::Values(TwistCase{-kPi, kPi, 3, 0, 3},
                                           TwistCase{0, 2 * kPi, -1, 0, -1},
                                           TwistCase{-6, 6, -3, 0, -3}));

INSTANTIATE_TEST_SUITE_P(Frozen, TwistLimitTest,
                         ::testing::Values(TwistCase{0.5, 0.5, 0.5, 0, 0.5},
                                           TwistCase{0.5, 0.5, 1, 0.5, 0.5}));

TEST(RotationLimitTest, TwistMayBeOpenOnOneSide) {
  JointLimits below;
  below.twist_upper_rad = 0.5;
  EXPECT_NEAR(Excess(below, Rotation(0.3, -3)), 0, kRounding);
  EXPECT_NEAR(Excess(below, Rotation(0.3, 0.75)), 0.25, kRounding);
  JointLimits above;
  above.twist_lower_rad = 0.5;
  EXPECT_NEAR(Excess(above, Rotation(0.3, 3)), 0, kRounding);
  EXPECT_NEAR(Excess(above, Rotation(0.3, 0.25)), 0.25, kRounding);
}

TEST(TwistRangeTest, ASideThatIsNotGivenEndsAtHalfATurn) {
  JointLimits limits;
  EXPECT_FALSE(TwistRangeOf(limits).has_value());
  limits.twist_lower_rad = -1;
  EXPECT_EQ(TwistRangeOf(limits)->lower_rad, -1);
  EXPECT_EQ(TwistRangeOf(limits)->upper_rad, kPi);
  limits.twist_lower_rad.reset();
  limits.twist_upper_rad = 1;
  EXPECT_EQ(TwistRangeOf(limits)->lower_rad, -kPi);
  EXPECT_EQ(TwistRangeOf(limits)->upper_rad, 1);
}

TEST(TwistRangeTest, AWholeTurnIsNone) {
  EXPECT_TRUE(TwistRangeOf(Twist(0, 2 * kPi - 1e-3)).has_value());
  EXPECT_FALSE(TwistRangeOf(Twist(0, 2 * kPi)).has_value());
  EXPECT_FALSE(TwistRangeOf(Twist(-3.1415927, 3.1415927)).has_value());
  EXPECT_FALSE(TwistRangeOf(Twist(-6, 6)).has_value());
}

// A swing of pi has no twist of its own.
TEST(RotationLimitTest, AnyTwistFitsASwingOfPi) {
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  const Eigen::Quaterniond swing = QuaternionXyzw(0, 1, 0, 0);
  JointLimits limits = Twist(1, 2);
  EXPECT_EQ(RotationLimitExcess(limits, axis, swing), 0);
  limits.swing_cone_rad = 3;
  EXPECT_NEAR(RotationLimitExcess(limits, axis, swing), M_PI - 3, kRounding);
  EXPECT_NEAR(
      RotationLimitExcess(limits, axis, ClampRotation(limits, axis, swing)), 0,
      kRounding);
}

TEST(RotationLimitTest, ClampIsInsideAndKeepsWhatIsInside) {
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    JointLimits limits = Twist(Uniform(random, -6, 0), Uniform(random, 0, 6));
    limits.swing_cone_rad = Uniform(random, 0, M_PI);
    const Eigen::Vector3d axis = RandomDirection(random);
    const Eigen::Quaterniond q = RandomRotation(random);
    const Eigen::Quaterniond clamped = ClampRotation(limits, axis, q);
    EXPECT_LE(RotationLimitExcess(limits, axis, clamped), kRounding);
    if (RotationLimitExcess(limits, axis, q) == 0) {
      EXPECT_EQ(clamped.coeffs(), q.coeffs());
    }
  }
}

}  // namespace
}  // namespace gelenk
