#include "gelenk/skin/half_rotation.h"

#include <gtest/gtest.h>

#include <numbers>

#include "gelenk/math/rotation.h"
#include "tests/testing/random.h"

namespace gelenk {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomDirection;
using ::gelenk::testing::RandomRotation;
using ::gelenk::testing::Uniform;

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-12;

TEST(HalfSwingAndTwistTest, BisectsTheLinks) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Quaterniond rotation = RandomRotation(random);
    const Vector3d half = HalfSwingAndTwist(rotation) * Vector3d::UnitX();
    const Vector3d whole = rotation * Vector3d::UnitX();
    EXPECT_NEAR(half.dot(Vector3d::UnitX()), half.dot(whole), kRounding);
    EXPECT_GE(half.dot(whole), -kRounding);
  }
}

TEST(HalfSwingAndTwistTest, HalvesSwingAndTwistByThemselves) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    SwingTwist parts;
    const double direction = Uniform(random, -kPi, kPi);
    parts.swing_axis = {0, std::cos(direction), std::sin(direction)};
    parts.swing_rad = Uniform(random, 0, 0.99 * kPi);
    parts.twist_rad = Uniform(random, -0.99 * kPi, 0.99 * kPi);
    const Quaterniond whole = ComposeSwingTwist(parts, Vector3d::UnitX());
    parts.swing_rad *= 0.5;
    parts.twist_rad *= 0.5;
    const Quaterniond half = ComposeSwingTwist(parts, Vector3d::UnitX());
    EXPECT_LE(AngleBetween(HalfSwingAndTwist(whole), half), 1e-11);
    const Quaterniond negated(Eigen::Vector4d(-whole.coeffs()));
    EXPECT_LE(AngleBetween(HalfSwingAndTwist(negated), half), 1e-11);
  }
}

TEST(HalfSwingAndTwistTest, HalfATurnIsARightAngle) {
  const Quaterniond half = HalfSwingAndTwist(Quaterniond(0, 0, 1, 0));
  EXPECT_NEAR(AngleBetween(half, Quaterniond::Identity()), kPi / 2, kRounding);
}

TEST(HalfHingeTest, IsContinuousForAWholeTurnEitherWay) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Quaterniond rest(
        Eigen::AngleAxisd(Uniform(random, 0, 1.2), RandomDirection(random)));
    const Vector3d axis = RandomDirection(random);
    constexpr double kStep = 0.01;
    for (double angle = -4; angle < 4; angle += kStep) {
      EXPECT_LE(AngleBetween(HalfHinge(rest, axis, angle),
                             HalfHinge(rest, axis, angle + kStep)),
                // A bent rest can make the half turn faster than the whole,
                // but it does not flip.
                4 * kStep);
    }
  }
}

TEST(HalfHingeTest, TwoHalvesAreTheWhole) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Quaterniond rest(
        Eigen::AngleAxisd(Uniform(random, 0, 1.2), RandomDirection(random)));
    const Vector3d axis = RandomDirection(random);
    const double angle = Uniform(random, -3, 3);
    const Quaterniond half = HalfHinge(rest, axis, angle);
    const Quaterniond whole =
        rest * Quaterniond(Eigen::AngleAxisd(angle, axis));
    EXPECT_LE(AngleBetween(half * half, whole), 1e-11);
  }
}

TEST(HalfHingeTest, CountsTurnsWithoutRest) {
  const Vector3d axis = Vector3d::UnitZ();
  for (double angle : {kPi - 0.01, kPi + 0.01, 2 * kPi, 7.0}) {
    EXPECT_LE(AngleBetween(HalfHinge(Quaterniond::Identity(), axis, angle),
                           Quaterniond(Eigen::AngleAxisd(0.5 * angle, axis))),
              kRounding);
  }
}

}  // namespace
}  // namespace gelenk
