// DecomposeSwingTwist and ComposeSwingTwist of math/rotation.h.
#include <gtest/gtest.h>

#include <cmath>

#include "gelenk/math/rotation.h"
#include "tests/testing/matrix_kinematics_oracle.h"
#include "tests/testing/random.h"

namespace gelenk {
namespace {

using ::gelenk::testing::AxisAngleMatrix;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomDirection;
using ::gelenk::testing::RandomRotation;
using ::gelenk::testing::Uniform;

// A few operations on numbers near 1.
constexpr double kRounding = 1e-14;
// Parts come back from a product of quaternions; 1e-16 over the sine or cosine
// of half a swing, at least 5e-4 here.
constexpr double kPartRounding = 1e-11;

SwingTwist RandomParts(Random& random, const Eigen::Vector3d& axis) {
  SwingTwist parts;
  parts.swing_rad = Uniform(random, 1e-3, M_PI - 1e-3);
  parts.swing_axis = axis.cross(RandomDirection(random)).normalized();
  parts.twist_rad = Uniform(random, -M_PI, M_PI);
  return parts;
}

TEST(SwingTwistTest, ComposeTwistsFirst) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d axis = RandomDirection(random);
    const SwingTwist parts = RandomParts(random, axis);
    const Eigen::Matrix3d want =
        AxisAngleMatrix(parts.swing_axis, parts.swing_rad) *
        AxisAngleMatrix(axis, parts.twist_rad);
    const Eigen::Matrix3d got =
        ComposeSwingTwist(parts, axis).toRotationMatrix();
    EXPECT_TRUE(got.isApprox(want, kRounding));
  }
}

TEST(SwingTwistTest, DecomposeFindsTheParts) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d axis = RandomDirection(random);
    const SwingTwist parts = RandomParts(random, axis);
    const SwingTwist found =
        DecomposeSwingTwist(ComposeSwingTwist(parts, axis), axis);
    EXPECT_NEAR(found.swing_rad, parts.swing_rad, kPartRounding);
    EXPECT_NEAR(found.twist_rad, parts.twist_rad, kPartRounding);
    EXPECT_LE((found.swing_axis - parts.swing_axis).norm(), kPartRounding);
  }
}

void ExpectRoundTrip(const Eigen::Quaterniond& q, const Eigen::Vector3d& axis) {
  const SwingTwist parts = DecomposeSwingTwist(q, axis);
  EXPECT_GE(parts.swing_rad, 0);
  EXPECT_LE(parts.swing_rad, M_PI);
  EXPECT_GT(parts.twist_rad, -M_PI);
  EXPECT_LE(parts.twist_rad, M_PI);
  EXPECT_NEAR(parts.swing_axis.norm(), 1, kRounding);
  EXPECT_NEAR(parts.swing_axis.dot(axis), 0, kRounding);
  EXPECT_LE(AngleBetween(ComposeSwingTwist(parts, axis), q), kPartRounding);
}

TEST(SwingTwistTest, ComposeUndoesDecomposeForBothSigns) {
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d axis = RandomDirection(random);
    const Eigen::Quaterniond q = RandomRotation(random);
    ExpectRoundTrip(q, axis);
    ExpectRoundTrip(QuaternionXyzw(-q.x(), -q.y(), -q.z(), -q.w()), axis);
  }
}

TEST(SwingTwistTest, BothSignsHaveTheSameParts) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d axis = RandomDirection(random);
    const Eigen::Quaterniond q = RandomRotation(random);
    const SwingTwist one = DecomposeSwingTwist(q, axis);
    const SwingTwist other = DecomposeSwingTwist(
        QuaternionXyzw(-q.x(), -q.y(), -q.z(), -q.w()), axis);
    EXPECT_NEAR(one.swing_rad, other.swing_rad, kRounding);
    EXPECT_NEAR(one.twist_rad, other.twist_rad, kRounding);
    EXPECT_LE((one.swing_axis - other.swing_axis).norm(), kPartRounding);
  }
}

TEST(SwingTwistTest, ExtremeSwingsAndTwistsRoundTrip) {
  Random random(5);
  const double nearly[] = {0, 1e-15, 1e-12, 1e-9, 1e-6};
  for (double swing : nearly) {
    for (double twist : nearly) {
      const Eigen::Vector3d axis = RandomDirection(random);
      SwingTwist parts = RandomParts(random, axis);
      for (double swing_rad : {swing, M_PI - swing}) {
        for (double twist_rad : {twist, -twist, M_PI - twist, twist - M_PI}) {
          parts.swing_rad = swing_rad;
          parts.twist_rad = twist_rad;
          ExpectRoundTrip(ComposeSwingTwist(parts, axis), axis);
        }
      }
    }
  }
}

TEST(SwingTwistTest, PureTwist) {
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  for (double twist : {-3.0, -1e-9, 0.0, 2.0, M_PI}) {
    const SwingTwist parts =
        DecomposeSwingTwist(ExpRotation(twist * axis), axis);
    EXPECT_NEAR(parts.swing_rad, 0, kRounding);
    EXPECT_NEAR(parts.twist_rad, twist, kRounding);
  }
}

TEST(SwingTwistTest, HalfTurnTwistIsPlusPiForBothSigns) {
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  for (double z : {1.0, -1.0}) {
    EXPECT_EQ(DecomposeSwingTwist(QuaternionXyzw(0, 0, z, 0), axis).twist_rad,
              M_PI);
  }
}

TEST(SwingTwistTest, TwistIsZeroAtASwingOfPi) {
  const SwingTwist parts =
      DecomposeSwingTwist(QuaternionXyzw(0, 1, 0, 0), Eigen::Vector3d::UnitX());
  EXPECT_EQ(parts.swing_rad, M_PI);
  EXPECT_EQ(parts.twist_rad, 0);
}

TEST(SwingTwistTest, SwingIsTheAngleBetweenTheAxisAndItsImage) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d axis = RandomDirection(random);
    const Eigen::Quaterniond q = RandomRotation(random);
    const Eigen::Vector3d image = q * axis;
    EXPECT_NEAR(DecomposeSwingTwist(q, axis).swing_rad,
                std::atan2(axis.cross(image).norm(), axis.dot(image)),
                kRounding);
  }
}

}  // namespace
}  // namespace gelenk
