#include "gelenk/math/rigid_transform.h"

#include <gtest/gtest.h>

#include "tests/testing/matrix_kinematics_oracle.h"
#include "tests/testing/random.h"

namespace gelenk {
namespace {

using ::gelenk::testing::MatrixOf;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomTransform;
using ::gelenk::testing::RandomVector;

// A few operations on numbers near 1.
constexpr double kRounding = 1e-14;

TEST(RigidTransformTest, RotatesThenTranslates) {
  RigidTransform a_from_b;
  a_from_b.rotation = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());
  a_from_b.translation = {10, 0, 0};
  const Eigen::Vector3d in_a = a_from_b * Eigen::Vector3d::UnitX();
  EXPECT_TRUE(in_a.isApprox(Eigen::Vector3d(10, 1, 0), kRounding));
}

TEST(RigidTransformTest, ProductIsThatOfTheMatrices) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const RigidTransform a_from_b = RandomTransform(random, 2);
    const RigidTransform b_from_c = RandomTransform(random, 2);
    const Eigen::Matrix4d product = MatrixOf(a_from_b) * MatrixOf(b_from_c);
    EXPECT_TRUE(MatrixOf(a_from_b * b_from_c).isApprox(product, kRounding));
    const Eigen::Vector3d in_c = RandomVector(random, 2);
    const Eigen::Vector3d in_a = (product * in_c.homogeneous()).head<3>();
    EXPECT_TRUE((a_from_b * b_from_c * in_c).isApprox(in_a, kRounding));
  }
}

TEST(RigidTransformTest, InverseUndoesFromBothSides) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const RigidTransform a_from_b = RandomTransform(random, 2);
    const Eigen::Matrix4d left = MatrixOf(a_from_b.Inverse() * a_from_b);
    const Eigen::Matrix4d right = MatrixOf(a_from_b * a_from_b.Inverse());
    EXPECT_TRUE(left.isIdentity(kRounding));
    EXPECT_TRUE(right.isIdentity(kRounding));
  }
}

}  // namespace
}  // namespace gelenk
