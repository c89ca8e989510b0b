#include "gelenk/skeleton/joint.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/testing/random.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::RandomDirection;

struct TypeCase {
  JointType type;
  absl::string_view name;
  int position_count;
  int velocity_count;
  bool needs_axis;
};

class JointTypeTest : public ::testing::TestWithParam<TypeCase> {};

TEST_P(JointTypeTest, HasItsNumbers) {
  const TypeCase& want = GetParam();
  EXPECT_EQ(JointTypeName(want.type), want.name);
  EXPECT_EQ(PositionCount(want.type), want.position_count);
  EXPECT_EQ(VelocityCount(want.type), want.velocity_count);
  EXPECT_EQ(NeedsAxis(want.type), want.needs_axis);
}

INSTANTIATE_TEST_SUITE_P(
    EachType, JointTypeTest,
    ::testing::Values(TypeCase{JointType::kFixed, "fixed", 0, 0, false},
                      TypeCase{JointType::kRevolute, "revolute", 1, 1, true},
                      TypeCase{JointType::kPrismatic, "prismatic", 1, 1, true},
                      TypeCase{JointType::kSpherical, "spherical", 4, 3, false},
                      TypeCase{JointType::kPlanar, "planar", 3, 3, true},
                      TypeCase{JointType::kFree, "free", 7, 6, false}));

// Rounding near -Z is larger; see ShortestRotation.
constexpr double kBasisRounding = 1e-7;

void ExpectRightHandedBasis(const Eigen::Vector3d& axis) {
  const Eigen::Matrix3d basis = PlanarBasis(axis);
  EXPECT_LE((basis.col(2) - axis).norm(), kBasisRounding) << axis.transpose();
  EXPECT_TRUE((basis.transpose() * basis).isIdentity(1e-14));
  EXPECT_NEAR(basis.determinant(), 1, 1e-14);
}

TEST(PlanarBasisTest, IsRightHandedAboutAnyAxis) {
  Random random(1);
  for (int i = 0; i < 100; ++i) ExpectRightHandedBasis(RandomDirection(random));
}

TEST(PlanarBasisTest, IsRightHandedAboutAndNearZ) {
  for (double tilt : {0.0, 1e-15, 1e-9, 1e-7, 1e-5, 1e-3}) {
    const Eigen::Vector3d axis(std::sin(tilt), 0, std::cos(tilt));
    ExpectRightHandedBasis(axis);
    ExpectRightHandedBasis(-axis);
  }
}

TEST(PlanarBasisTest, AboutZIsTheXyPlane) {
  EXPECT_TRUE(PlanarBasis(Eigen::Vector3d::UnitZ()).isIdentity(0));
}

}  // namespace
}  // namespace gelenk
