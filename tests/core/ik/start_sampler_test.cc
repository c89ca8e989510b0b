#include "gelenk/ik/start_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/testing/example_skeletons.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::PandaArm;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::RandomSkeleton;

Eigen::VectorXd Drawn(StartSampler& sampler, const Skeleton& skeleton,
                      const Eigen::VectorXd& start) {
  std::vector<int> joints;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    if (skeleton.span(i).position_offset >= 0) joints.push_back(i);
  }
  Eigen::VectorXd positions = start;
  sampler.Sample(skeleton, joints, start, positions);
  return positions;
}

TEST(StartSamplerTest, SeedDecides) {
  Random random(1);
  const auto skeleton = RandomSkeleton(random);
  const Eigen::VectorXd start = RandomPoseWithinLimits(random, *skeleton);
  StartSampler first(7);
  StartSampler second(7);
  StartSampler other(8);
  const Eigen::VectorXd drawn = Drawn(first, *skeleton, start);
  EXPECT_EQ(drawn, Drawn(second, *skeleton, start));
  EXPECT_NE(drawn, Drawn(other, *skeleton, start));
  EXPECT_NE(drawn, Drawn(first, *skeleton, start));
}

TEST(StartSamplerTest, StaysWithinLimits) {
  // See kRounding of pose_limits_test.cc.
  constexpr double kRounding = 1e-11;
  Random random(2);
  StartSampler sampler(0);
  for (int tree = 0; tree < 200; ++tree) {
    const auto skeleton = RandomSkeleton(random);
    Eigen::VectorXd drawn =
        Drawn(sampler, *skeleton, RandomPoseWithinLimits(random, *skeleton));
    EXPECT_LE(LimitExcess(*skeleton, drawn, nullptr), kRounding);
    EXPECT_TRUE(CheckPositions(*skeleton, drawn).ok());
  }
}

TEST(StartSamplerTest, CoversTheRangeOfLimitedJoints) {
  const auto panda = PandaArm();
  const Eigen::VectorXd start = Eigen::VectorXd::Zero(7);
  StartSampler sampler(0);
  Eigen::VectorXd lowest = Drawn(sampler, *panda, start);
  Eigen::VectorXd highest = lowest;
  for (int i = 0; i < 500; ++i) {
    const Eigen::VectorXd drawn = Drawn(sampler, *panda, start);
    lowest = lowest.cwiseMin(drawn);
    highest = highest.cwiseMax(drawn);
  }
  for (int j = 0; j < 7; ++j) {
    const JointLimits& limits = panda->joint(j).limits;
    const double margin = 0.05 * (limits.upper[0] - limits.lower[0]);
    EXPECT_LT(lowest[j], limits.lower[0] + margin);
    EXPECT_GT(highest[j], limits.upper[0] - margin);
  }
}

TEST(StartSamplerTest, LeavesTheOtherJoints) {
  const auto panda = PandaArm();
  const Eigen::VectorXd start = Eigen::VectorXd::Zero(7);
  Eigen::VectorXd positions = start;
  StartSampler(0).Sample(*panda, {1, 4}, start, positions);
  for (int j = 0; j < 7; ++j) {
    EXPECT_EQ(positions[j] != 0, j == 1 || j == 4) << j;
  }
}

TEST(StartSamplerTest, KeepsAFreeBodyNearItsStart) {
  Joint root;
  root.id = "root";
  root.type = JointType::kFree;
  const auto body = SkeletonBuilder().AddJoint(root).Build().value();
  Eigen::VectorXd start(7);
  start << 100, 200, 300, 0, 0, 0, 1;
  StartSampler sampler(0);
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd drawn = Drawn(sampler, *body, start);
    EXPECT_LE((drawn - start).head<3>().cwiseAbs().maxCoeff(), 0.3);
  }
}

TEST(StartSamplerTest, HalfOpenLimitsHold) {
  Joint slider;
  slider.id = "slider";
  slider.type = JointType::kPrismatic;
  for (double bound : {-10.0, 0.0, 10.0}) {
    for (bool above : {false, true}) {
      slider.limits.lower = {above ? bound : -INFINITY};
      slider.limits.upper = {above ? INFINITY : bound};
      const auto skeleton = SkeletonBuilder().AddJoint(slider).Build().value();
      StartSampler sampler(0);
      const Eigen::VectorXd drawn =
          Drawn(sampler, *skeleton, Eigen::VectorXd::Zero(1));
      EXPECT_EQ(LimitExcess(*skeleton, drawn, nullptr), 0);
    }
  }
}

TEST(StartSamplerTest, LimitsFarApartAreAsGoodAsNone) {
  constexpr double kPi = 3.141592653589793;
  const StartRange turns = RangeOfStarts(true, 5, -1e6, 1e6);
  EXPECT_DOUBLE_EQ(turns.lower, -kPi);
  EXPECT_DOUBLE_EQ(turns.upper, kPi);
  // A whole turn, wherever it lies.
  const StartRange beyond = RangeOfStarts(true, 5, 1, 100);
  EXPECT_DOUBLE_EQ(beyond.lower, 1);
  EXPECT_DOUBLE_EQ(beyond.upper, 1 + 2 * kPi);
  const StartRange slide = RangeOfStarts(false, 5, -1e6, 1e6);
  EXPECT_DOUBLE_EQ(slide.lower, 4.7);
  EXPECT_DOUBLE_EQ(slide.upper, 5.3);
  // Two turns of a robot's joint are meant.
  const StartRange robot = RangeOfStarts(true, 0, -2 * kPi, 2 * kPi);
  EXPECT_EQ(robot.lower, -2 * kPi);
  EXPECT_EQ(robot.upper, 2 * kPi);
}

}  // namespace
}  // namespace gelenk
