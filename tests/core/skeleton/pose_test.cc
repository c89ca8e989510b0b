#include "gelenk/skeleton/pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gelenk/math/rotation.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RandomVelocity;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;

// A few operations on numbers near pi.
constexpr double kRounding = 1e-14;

// A free root and a ball joint: q = [t q q], 11 numbers, 9 velocities.
std::shared_ptr<const Skeleton> FreeAndBall() {
  Joint root;
  root.id = "root";
  root.type = JointType::kFree;
  Joint ball;
  ball.id = "ball";
  ball.parent_id = "root";
  ball.type = JointType::kSpherical;
  return SkeletonBuilder().AddJoint(root).AddJoint(ball).Build().value();
}

// As poses: q and -q are the same rotation.
double Distance(const Skeleton& skeleton, const Eigen::VectorXd& a,
                const Eigen::VectorXd& b) {
  Eigen::VectorXd difference(skeleton.velocity_count());
  Difference(skeleton, a, b, difference);
  return difference.norm();
}

TEST(NeutralPositionsTest, IsZerosAndIdentities) {
  Eigen::VectorXd want = Eigen::VectorXd::Zero(11);
  want[6] = want[10] = 1;
  EXPECT_EQ(NeutralPositions(*FreeAndBall()), want);
}

TEST(CheckPositionsTest, WantsTheRightSize) {
  for (int size : {0, 10, 12}) {
    Eigen::VectorXd positions = Eigen::VectorXd::Zero(size);
    EXPECT_THAT(
        ViolationLines(CheckPositions(*FreeAndBall(), positions)),
        ElementsAre("positions: want 11 numbers, got " + std::to_string(size)));
  }
}

TEST(CheckPositionsTest, NamesEveryBadNumber) {
  Eigen::VectorXd positions = NeutralPositions(*FreeAndBall());
  positions[1] = NAN;
  positions[4] = INFINITY;
  positions[10] = 0.9;
  EXPECT_THAT(ViolationLines(CheckPositions(*FreeAndBall(), positions)),
              ElementsAre("positions[1]: want a finite number, got nan",
                          "positions[4]: want a finite number, got inf",
                          "positions[7]: want a unit quaternion, got "
                          "(0, 0, 0, 0.9)"));
}

TEST(CheckPositionsTest, NormalisesNearOnesAndKeepsExactOnes) {
  Eigen::VectorXd positions = NeutralPositions(*FreeAndBall());
  positions.segment<4>(3) << 0.1, -0.5, 0.7, 0.5;
  positions.segment<4>(7) << 0, 0.8006, 0, 0.6;
  const Eigen::VectorXd given = positions;
  EXPECT_TRUE(CheckPositions(*FreeAndBall(), positions).ok());
  EXPECT_EQ(positions.head<7>(), given.head<7>());
  EXPECT_NEAR(positions.tail<4>().norm(), 1, 1e-15);
  EXPECT_NEAR(positions[8] / positions[10], 0.8006 / 0.6, kRounding);
}

TEST(IntegrateTest, MovesEachCoordinateItsOwnWay) {
  Eigen::VectorXd positions = NeutralPositions(*FreeAndBall());
  positions.segment<4>(3) << 0, 0, 1, 0;  // Half a turn about Z.
  Eigen::VectorXd velocity(9);
  // Translation in the rest frame, rotation in the turned body's frame.
  velocity << 1, 2, 3, 0.2, 0, 0, 0, 0, -0.4;
  Eigen::VectorXd moved(11);
  Integrate(*FreeAndBall(), positions, velocity, moved);
  EXPECT_EQ(moved.head<3>(), Eigen::Vector3d(1, 2, 3));
  const Eigen::Quaterniond body =
      QuaternionXyzw(0, 0, 1, 0) * ExpRotation(Eigen::Vector3d(0.2, 0, 0));
  EXPECT_LE(AngleBetween(QuaternionXyzw(moved.data() + 3), body), kRounding);
  EXPECT_NEAR(moved[9], std::sin(-0.2), kRounding);
  EXPECT_NEAR(moved[10], std::cos(-0.2), kRounding);
}

TEST(IntegrateTest, ResultMayBeTheStart) {
  Random random(1);
  const auto skeleton = RandomSkeleton(random);
  Eigen::VectorXd positions = RandomPose(random, *skeleton);
  const Eigen::VectorXd velocity = RandomVelocity(random, *skeleton, 2);
  Eigen::VectorXd moved(positions.size());
  Integrate(*skeleton, positions, velocity, moved);
  Integrate(*skeleton, positions, velocity, positions);
  EXPECT_EQ(positions, moved);
}

TEST(IntegrateTest, UndoesDifference) {
  Random random(2);
  for (int tree = 0; tree < 100; ++tree) {
    const auto skeleton = RandomSkeleton(random);
    const Eigen::VectorXd from = RandomPose(random, *skeleton);
    const Eigen::VectorXd to = RandomPose(random, *skeleton);
    Eigen::VectorXd velocity(skeleton->velocity_count());
    Difference(*skeleton, from, to, velocity);
    Eigen::VectorXd arrived(from.size());
    Integrate(*skeleton, from, velocity, arrived);
    EXPECT_LE(Distance(*skeleton, arrived, to), 10 * kRounding);
  }
}

TEST(DifferenceTest, UndoesIntegrateUpToHalfATurn) {
  Random random(3);
  for (double size : {0.0, 1e-12, 1e-8, 1e-3, 1.0}) {
    for (int tree = 0; tree < 20; ++tree) {
      const auto skeleton = RandomSkeleton(random);
      const Eigen::VectorXd from = RandomPose(random, *skeleton);
      const Eigen::VectorXd velocity = RandomVelocity(random, *skeleton, size);
      Eigen::VectorXd to(from.size());
      Integrate(*skeleton, from, velocity, to);
      Eigen::VectorXd found(velocity.size());
      Difference(*skeleton, from, to, found);
      EXPECT_LE((found - velocity).norm(), 10 * kRounding) << size;
    }
  }
}

TEST(DifferenceTest, OfAPoseToItselfIsZero) {
  Random random(4);
  const auto skeleton = RandomSkeleton(random);
  const Eigen::VectorXd positions = RandomPose(random, *skeleton);
  EXPECT_LE(Distance(*skeleton, positions, positions), kRounding);
}

TEST(ScalarPositionTest, FollowsTheMimic) {
  Joint root;
  root.id = "root";
  root.type = JointType::kPrismatic;
  Joint follower = root;
  follower.id = "follower";
  follower.parent_id = "root";
  follower.type = JointType::kRevolute;
  follower.mimic = Mimic{"root", -2, 0.5};
  const auto skeleton =
      SkeletonBuilder().AddJoint(root).AddJoint(follower).Build().value();
  const Eigen::VectorXd positions = Eigen::VectorXd::Constant(1, 0.3);
  EXPECT_EQ(ScalarPosition(*skeleton, positions, 0), 0.3);
  EXPECT_NEAR(ScalarPosition(*skeleton, positions, 1), -0.1, kRounding);
}

TEST(AlignHemispheresTest, FlipsOnlyQuaternionsAcross) {
  const auto skeleton = FreeAndBall();
  Random random(5);
  for (int i = 0; i < 50; ++i) {
    const Eigen::VectorXd reference = RandomPose(random, *skeleton);
    const Eigen::VectorXd positions = RandomPose(random, *skeleton);
    Eigen::VectorXd aligned = positions;
    AlignHemispheres(*skeleton, reference, aligned);
    EXPECT_EQ(aligned.head<3>(), positions.head<3>());
    for (int at : {3, 7}) {
      const Eigen::Vector4d q = positions.segment<4>(at);
      const bool across = q.dot(reference.segment<4>(at)) < 0;
      EXPECT_EQ(aligned.segment<4>(at), across ? Eigen::Vector4d(-q) : q);
    }
  }
}

}  // namespace
}  // namespace gelenk
