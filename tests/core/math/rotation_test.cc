#include "gelenk/math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/testing/matrix_kinematics_oracle.h"
#include "tests/testing/random.h"

namespace gelenk {
namespace {

using ::gelenk::testing::AxisAngleMatrix;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomDirection;
using ::gelenk::testing::RandomRotation;

// A few operations on numbers near 1.
constexpr double kRounding = 1e-14;

// As a rotation: q and -q are the same.
void ExpectSameRotation(const Eigen::Quaterniond& a,
                        const Eigen::Quaterniond& b, double tolerance) {
  EXPECT_NEAR(a.norm(), 1, tolerance);
  const double sign = a.dot(b) < 0 ? -1 : 1;
  EXPECT_LE((a.coeffs() - sign * b.coeffs()).norm(), tolerance);
}

TEST(QuaternionTest, IsStoredXyzw) {
  const Eigen::Quaterniond q = QuaternionXyzw(0.1, 0.2, 0.3, 0.9);
  EXPECT_EQ(q.x(), 0.1);
  EXPECT_EQ(q.y(), 0.2);
  EXPECT_EQ(q.z(), 0.3);
  EXPECT_EQ(q.w(), 0.9);
  double xyzw[4];
  StoreXyzw(q, xyzw);
  EXPECT_EQ(xyzw[0], 0.1);
  EXPECT_EQ(xyzw[3], 0.9);
  EXPECT_EQ(QuaternionXyzw(xyzw).coeffs(), q.coeffs());
}

class NormalizeTest : public ::testing::Test {
 protected:
  // A skew unit quaternion times `norm`.
  void SetNorm(double norm) {
    for (int i = 0; i < 4; ++i) xyzw_[i] = norm * kSkew[i];
  }
  double Norm() const {
    return Eigen::Map<const Eigen::Vector4d>(xyzw_).norm();
  }

  static constexpr double kSkew[4] = {0.1, -0.5, 0.7, 0.5};  // Norm 1.
  double xyzw_[4];
};

TEST_F(NormalizeTest, TakesExactOnesBitByBit) {
  for (double norm : {1.0, 1 + 0.9e-12, 1 - 0.9e-12}) {
    SetNorm(norm);
    EXPECT_TRUE(NormalizeNearUnit(xyzw_));
    for (int i = 0; i < 4; ++i) EXPECT_EQ(xyzw_[i], norm * kSkew[i]);
  }
}

TEST_F(NormalizeTest, NormalisesNearOnes) {
  for (double norm : {1 + 1.1e-12, 1 - 1.1e-12, 1 + 0.999e-3, 1 - 0.999e-3}) {
    SetNorm(norm);
    EXPECT_TRUE(NormalizeNearUnit(xyzw_)) << norm - 1;
    EXPECT_NEAR(Norm(), 1, 4 * std::numeric_limits<double>::epsilon());
  }
}

TEST_F(NormalizeTest, RefusesOthersAndLeavesThem) {
  for (double norm : {1 + 1.001e-3, 1 - 1.001e-3, 0.0, -0.5, 1e200}) {
    SetNorm(norm);
    EXPECT_FALSE(NormalizeNearUnit(xyzw_)) << norm;
    for (int i = 0; i < 4; ++i) EXPECT_EQ(xyzw_[i], norm * kSkew[i]);
  }
}

TEST_F(NormalizeTest, RefusesWhatIsNotFinite) {
  for (double bad : {NAN, INFINITY, -INFINITY}) {
    for (int i = 0; i < 4; ++i) {
      SetNorm(1);
      xyzw_[i] = bad;
      EXPECT_FALSE(NormalizeNearUnit(xyzw_));
    }
  }
}

TEST(ExpRotationTest, TurnsAboutTheVectorByItsLength) {
  Random random(1);
  for (double angle : {0.0, 1e-300, 1e-9, 1e-8, 1e-4, 1.0, 3.0, 6.0, 20.0}) {
    const Eigen::Vector3d axis = RandomDirection(random);
    const Eigen::Matrix3d turned = ExpRotation(angle * axis).toRotationMatrix();
    EXPECT_TRUE(turned.isApprox(AxisAngleMatrix(axis, angle), kRounding))
        << angle;
  }
}

TEST(LogRotationTest, UndoesExpUpToHalfATurn) {
  Random random(2);
  for (double angle : {0.0, 1e-300, 1e-12, 1e-8, 1e-4, 1.0, 3.0, 3.14159265}) {
    const Eigen::Vector3d vector = angle * RandomDirection(random);
    const Eigen::Vector3d log = LogRotation(ExpRotation(vector));
    EXPECT_LE((log - vector).norm(), kRounding * (angle + 1e-3)) << angle;
  }
}

TEST(LogRotationTest, ExpUndoesLogForBothSigns) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Quaterniond q = RandomRotation(random);
    const Eigen::Vector3d log = LogRotation(q);
    EXPECT_LE(log.norm(), M_PI + kRounding);
    ExpectSameRotation(ExpRotation(log), q, kRounding);
    EXPECT_EQ(LogRotation(QuaternionXyzw(-q.x(), -q.y(), -q.z(), -q.w())), log);
  }
}

TEST(LogRotationTest, HalfATurnIsPiLong) {
  EXPECT_NEAR(LogRotation(QuaternionXyzw(0, 1, 0, 0)).norm(), M_PI, kRounding);
}

TEST(AngleBetweenTest, IsTheAngleOfTheDifference) {
  Random random(4);
  for (double angle : {0.0, 1e-12, 1e-4, 1.0, 3.0, M_PI}) {
    const Eigen::Quaterniond a = RandomRotation(random);
    const Eigen::Quaterniond b =
        a * ExpRotation(angle * RandomDirection(random));
    EXPECT_NEAR(AngleBetween(a, b), angle, kRounding);
    EXPECT_NEAR(AngleBetween(b, a), angle, kRounding);
    const Eigen::Quaterniond same_b(-b.w(), -b.x(), -b.y(), -b.z());
    EXPECT_NEAR(AngleBetween(a, same_b), angle, kRounding);
  }
}

TEST(InHemisphereOfTest, FlipsOnlyWhatIsAcross) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Quaterniond reference = RandomRotation(random);
    const Eigen::Quaterniond q = RandomRotation(random);
    const Eigen::Quaterniond same = InHemisphereOf(reference, q);
    EXPECT_GE(reference.dot(same), 0);
    EXPECT_EQ(same.coeffs().cwiseAbs(), q.coeffs().cwiseAbs());
    if (reference.dot(q) >= 0) {
      EXPECT_EQ(same.coeffs(), q.coeffs());
    }
  }
}

// Direction errors of unit vectors are 1e-16; where the vectors are almost
// opposite the middle between them magnifies them up to 1e-16 / 1e-8.
constexpr double kOppositeRounding = 1e-7;

void ExpectShortestRotation(const Eigen::Vector3d& from,
                            const Eigen::Vector3d& to) {
  const Eigen::Quaterniond q = ShortestRotation(from, to);
  EXPECT_NEAR(q.norm(), 1, kRounding);
  EXPECT_LE((q * from - to).norm(), kOppositeRounding);
  const double angle = std::atan2(from.cross(to).norm(), from.dot(to));
  EXPECT_NEAR(AngleBetween(Eigen::Quaterniond::Identity(), q), angle,
              kOppositeRounding);
}

TEST(ShortestRotationTest, TakesOneToTheOther) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    ExpectShortestRotation(RandomDirection(random), RandomDirection(random));
  }
}

TEST(ShortestRotationTest, IsUnitNearAlikeAndOppositeVectors) {
  Random random(7);
  for (double angle : {0.0, 1e-15, 1e-9, 0.9e-8, 1.1e-8, 1e-7, 1e-5, 1e-3}) {
    const Eigen::Vector3d from = RandomDirection(random);
    const Eigen::Vector3d across =
        from.cross(RandomDirection(random)).normalized();
    const Eigen::Vector3d near = AxisAngleMatrix(across, angle) * from;
    ExpectShortestRotation(from, near);
    ExpectShortestRotation(from, -near);
  }
}

TEST(ShortestRotationTest, HalfTurnOfZIsAboutY) {
  const Eigen::Quaterniond q =
      ShortestRotation(Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitZ());
  EXPECT_LE((q * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitX()).norm(),
            kRounding);
  EXPECT_LE((q * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitY()).norm(),
            kRounding);
}

}  // namespace
}  // namespace gelenk
