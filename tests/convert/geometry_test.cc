#include "convert/geometry.h"

#include <gtest/gtest.h>

#include "gelenk/math/rotation.h"
#include "tests/testing/random.h"

namespace gelenk::convert {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::RandomTransform;

TEST(ConvertGeometryTest, EveryNumberHasItsField) {
  v1::Vector3 vector;
  ToProto(Eigen::Vector3d(1, 2, 3), &vector);
  EXPECT_EQ(vector.x(), 1);
  EXPECT_EQ(vector.y(), 2);
  EXPECT_EQ(vector.z(), 3);
  v1::Quaternion rotation;
  ToProto(QuaternionXyzw(0.1, 0.2, 0.3, 0.4), &rotation);
  EXPECT_EQ(rotation.x(), 0.1);
  EXPECT_EQ(rotation.y(), 0.2);
  EXPECT_EQ(rotation.z(), 0.3);
  EXPECT_EQ(rotation.w(), 0.4);
}

TEST(ConvertGeometryTest, TransformsComeRoundBitByBit) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const RigidTransform transform = RandomTransform(random, 10);
    v1::RigidTransform proto;
    ToProto(transform, &proto);
    v1::RigidTransform sent;
    ASSERT_TRUE(sent.ParseFromString(proto.SerializeAsString()));
    const RigidTransform again = FromProto(sent);
    EXPECT_EQ(again.translation, transform.translation);
    EXPECT_EQ(again.rotation.coeffs(), transform.rotation.coeffs());
  }
}

TEST(ConvertGeometryTest, UnsetMeansZeroAndIdentity) {
  const RigidTransform transform = FromProto(v1::RigidTransform());
  EXPECT_EQ(transform.translation, Eigen::Vector3d::Zero());
  EXPECT_EQ(transform.rotation.coeffs(),
            Eigen::Quaterniond::Identity().coeffs());
}

TEST(ConvertGeometryTest, ARotationOfZerosStaysOne) {
  v1::RigidTransform proto;
  proto.mutable_rotation();
  EXPECT_EQ(FromProto(proto).rotation.coeffs(), Eigen::Vector4d::Zero())
      << "for the checks to refuse";
}

}  // namespace
}  // namespace gelenk::convert
