#include "tests/testing/random_pose.h"

#include <gtest/gtest.h>

#include "gelenk/skeleton/pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk::testing {
namespace {

TEST(RandomPoseTest, IsAPose) {
  Random random(5);
  for (int tree = 0; tree < 50; ++tree) {
    const auto skeleton = RandomSkeleton(random);
    Eigen::VectorXd anywhere = RandomPose(random, *skeleton);
    Eigen::VectorXd within = RandomPoseWithinLimits(random, *skeleton);
    EXPECT_TRUE(CheckPositions(*skeleton, anywhere).ok());
    EXPECT_TRUE(CheckPositions(*skeleton, within).ok());
  }
}

TEST(RandomPoseTest, StaysWithinLimitsOnlyWhenAsked) {
  // Angles come back from quaternions with rounding errors that grow as the
  // swing nears pi; the draw stays 1e-3 rad away.
  constexpr double kAngleRounding = 1e-12;
  Random random(6);
  int outside = 0;
  for (int tree = 0; tree < 200; ++tree) {
    const auto skeleton = RandomSkeleton(random);
    EXPECT_LE(LimitExcess(*skeleton, RandomPoseWithinLimits(random, *skeleton),
                          nullptr),
              kAngleRounding);
    outside +=
        LimitExcess(*skeleton, RandomPose(random, *skeleton), nullptr) > 0.1;
  }
  EXPECT_GT(outside, 100);
}

}  // namespace
}  // namespace gelenk::testing
