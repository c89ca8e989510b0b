#include "convert/pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/testing/example_bodies.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/violation_lines.h"

namespace gelenk::convert {
namespace {

using ::gelenk::testing::PersonWithFingers;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(ConvertPoseTest, ComesRoundBitByBit) {
  const auto body = PersonWithFingers();
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Eigen::VectorXd positions = RandomPose(random, *body);
    v1::Pose proto;
    ToProto(positions, &proto);
    v1::Pose sent;
    ASSERT_TRUE(sent.ParseFromString(proto.SerializeAsString()));
    const auto again = FromProto(*body, sent);
    ASSERT_TRUE(again.ok()) << again.status();
    EXPECT_EQ(*again, positions);
  }
}

TEST(ConvertPoseTest, ReplacesWhatTheMessageHeld) {
  v1::Pose proto;
  for (int i = 0; i < 9; ++i) proto.add_positions(9);
  ToProto(Eigen::Vector3d(1, 2, 3), &proto);
  EXPECT_THAT(proto.positions(), ElementsAre(1, 2, 3));
}

TEST(ConvertPoseTest, RefusesOtherSizes) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1});
  v1::Pose proto;
  for (int size = 0; size < 4; ++size, proto.add_positions(0)) {
    EXPECT_EQ(FromProto(*chain, proto).ok(), size == 2) << size;
  }
}

TEST(ConvertPoseTest, RefusesWhatIsNoPose) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1});
  v1::Pose proto;
  proto.add_positions(0);
  proto.add_positions(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(ViolationLines(FromProto(*chain, proto).status()),
              ElementsAre(HasSubstr("positions[1]: ")));
}

TEST(ConvertPoseTest, JointFramesAreFlatAndNearForwardKinematics) {
  const auto body = PersonWithFingers();
  Random random(3);
  WorldTransforms frames;
  ForwardKinematics(*body, RandomPose(random, *body), frames);
  v1::JointFrames proto;
  proto.add_world_translations(99);
  ToProto(frames, &proto);
  ASSERT_THAT(proto.world_translations(), SizeIs(3 * 64));
  ASSERT_THAT(proto.world_rotations(), SizeIs(4 * 64));
  // Single precision at the size of a person.
  constexpr double kTolerance = 1e-6;
  for (int i = 0; i < 64; ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(proto.world_translations(3 * i + k), frames[i].translation[k],
                  kTolerance);
    }
    EXPECT_NEAR(proto.world_rotations(4 * i + 0), frames[i].rotation.x(),
                kTolerance);
    EXPECT_NEAR(proto.world_rotations(4 * i + 3), frames[i].rotation.w(),
                kTolerance);
  }
}

}  // namespace
}  // namespace gelenk::convert
