#include "gelenk/skeleton/position_bounds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {
namespace {

// Bounds are divided by multipliers.
constexpr double kRounding = 1e-12;

Joint Hinge(const std::string& id, const std::string& parent_id) {
  Joint joint;
  joint.id = id;
  joint.parent_id = parent_id;
  joint.type = JointType::kRevolute;
  return joint;
}

TEST(PositionBoundsTest, AreInfiniteWithoutLimits) {
  Joint body;
  body.id = "body";
  body.type = JointType::kFree;
  body.limits.lower = {-1, -2, -3};
  body.limits.upper = {1, 2, INFINITY};
  const auto skeleton = SkeletonBuilder()
                            .AddJoint(body)
                            .AddJoint(Hinge("hinge", "body"))
                            .Build()
                            .value();
  Eigen::VectorXd lower(8);
  lower << -1, -2, -3, Eigen::VectorXd::Constant(5, -INFINITY);
  Eigen::VectorXd upper(8);
  upper << 1, 2, Eigen::VectorXd::Constant(6, INFINITY);
  EXPECT_EQ(skeleton->position_bounds().lower, lower);
  EXPECT_EQ(skeleton->position_bounds().upper, upper);
}

// A driver that may turn from -2 to 2, and what follows it from -0.75 to 0.5.
std::shared_ptr<const Skeleton> LimitedFollower(double multiplier,
                                                double offset) {
  Joint driver = Hinge("driver", "");
  driver.limits.lower = {-2};
  driver.limits.upper = {2};
  Joint follower = Hinge("follower", "driver");
  follower.mimic = Mimic{"driver", multiplier, offset};
  follower.limits.lower = {-0.75};
  follower.limits.upper = {0.5};
  return SkeletonBuilder().AddJoint(driver).AddJoint(follower).Build().value();
}

struct FollowerCase {
  double multiplier;
  double offset;
  // Range of the driver.
  double lower;
  double upper;
};

class FollowerBoundsTest : public ::testing::TestWithParam<FollowerCase> {};

TEST_P(FollowerBoundsTest, NarrowTheDriver) {
  const FollowerCase& c = GetParam();
  const auto finger = LimitedFollower(c.multiplier, c.offset);
  EXPECT_NEAR(finger->position_bounds().lower[0], c.lower, kRounding);
  EXPECT_NEAR(finger->position_bounds().upper[0], c.upper, kRounding);
}

TEST_P(FollowerBoundsTest, HoldThePose) {
  const FollowerCase& c = GetParam();
  const auto finger = LimitedFollower(c.multiplier, c.offset);
  for (double side : {c.lower, c.upper}) {
    const double outwards = side == c.lower ? -0.125 : 0.125;
    Eigen::VectorXd positions = Eigen::VectorXd::Constant(1, side + outwards);
    int joint = -1;
    EXPECT_NEAR(LimitExcess(*finger, positions, &joint), 0.125, kRounding);
    EXPECT_EQ(joint, 0);
    EXPECT_NEAR(ClampToLimits(*finger, positions), 0.125, kRounding);
    EXPECT_NEAR(positions[0], side, kRounding);
    positions[0] = side - outwards;
    EXPECT_EQ(LimitExcess(*finger, positions, &joint), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Multipliers, FollowerBoundsTest,
    ::testing::Values(FollowerCase{1, 0, -0.75, 0.5},
                      FollowerCase{2, 0, -0.375, 0.25},
                      FollowerCase{-1, 0, -0.5, 0.75},
                      FollowerCase{0.5, 0.25, -2, 0.5},
                      FollowerCase{0.1, 0, -2, 2},
                      // Stands still whatever the driver does.
                      FollowerCase{0, 0, -2, 2},
                      // Cannot be met: the driver's own limits stand.
                      FollowerCase{0.1, 5, -2, 2}));

TEST(PositionBoundsTest, ClampedDriversKeepTheirFollowersInside) {
  const auto finger = LimitedFollower(-1.7, 0.1);
  for (double start : {-3.0, 0.0, 3.0}) {
    Eigen::VectorXd positions = Eigen::VectorXd::Constant(1, start);
    ClampToLimits(*finger, positions);
    const double follower = ScalarPosition(*finger, positions, 1);
    EXPECT_GE(follower, -0.75 - kRounding);
    EXPECT_LE(follower, 0.5 + kRounding);
  }
}

}  // namespace
}  // namespace gelenk
