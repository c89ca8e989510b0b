#include "tests/testing/matrix_kinematics_oracle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/testing/example_skeletons.h"
#include "tests/testing/random.h"

namespace gelenk::testing {
namespace {

// A few operations on numbers near 1.
constexpr double kRounding = 1e-14;

TEST(MatrixKinematicsOracleTest, RotationFormulasAgreeWithEachOther) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d axis = RandomDirection(random);
    const double angle = Uniform(random, -M_PI, M_PI);
    const Eigen::Vector3d v = std::sin(angle / 2) * axis;
    EXPECT_TRUE(AxisAngleMatrix(axis, angle)
                    .isApprox(QuaternionMatrix(v.x(), v.y(), v.z(),
                                               std::cos(angle / 2)),
                              kRounding));
  }
}

TEST(MatrixKinematicsOracleTest, QuarterTurnAboutZTakesXToY) {
  const Eigen::Vector3d turned =
      AxisAngleMatrix(Eigen::Vector3d::UnitZ(), M_PI / 2) *
      Eigen::Vector3d::UnitX();
  EXPECT_TRUE(turned.isApprox(Eigen::Vector3d::UnitY(), kRounding));
}

TEST(MatrixKinematicsOracleTest, StretchedPandaIsAsTallAsItsLinks) {
  const auto panda = PandaArm();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(7);
  const MatrixKinematicsOracle oracle(*panda, zero);
  // At zero the flange looks down, 88 mm in front of the column.
  const Eigen::Matrix4d tip = oracle.WorldFromEndEffector("tip");
  EXPECT_NEAR(tip(0, 3), 0.088, kRounding);
  EXPECT_NEAR(tip(1, 3), 0, kRounding);
  EXPECT_NEAR(tip(2, 3), 0.333 + 0.316 + 0.384 - 0.107, kRounding);
  EXPECT_NEAR(tip(2, 2), -1, kRounding);
}

TEST(MatrixKinematicsOracleTest, DistanceAndAngleBetweenFrames) {
  const Eigen::Matrix4d still = Eigen::Matrix4d::Identity();
  for (double angle : {0.0, 1e-9, 1.0, 3.1}) {
    Eigen::Matrix4d moved = still;
    moved.topLeftCorner<3, 3>() =
        AxisAngleMatrix(Eigen::Vector3d::UnitY(), angle);
    moved.col(3).head<3>() << 3, 0, 4;
    EXPECT_NEAR(AxesAngle(still, moved), angle, kRounding);
    EXPECT_NEAR(OriginDistance(still, moved), 5, kRounding);
  }
}

}  // namespace
}  // namespace gelenk::testing
