#include "gelenk/kinematics/center_of_mass.h"

#include <gtest/gtest.h>

#include <memory>

#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/matrix_kinematics_oracle.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::MatrixKinematicsOracle;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeletonBuilder;
using ::gelenk::testing::RandomVector;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::WithProbability;

constexpr double kRounding = 1e-12;
// See jacobian_test.cc.
constexpr double kStep = 1e-5;
constexpr double kDifferenceError = 1e-7;

using RowMajorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Some links massless, some off their joint.
std::shared_ptr<const Skeleton> HeavySkeleton(Random& random) {
  const auto plain = RandomSkeletonBuilder(random, {}).Build().value();
  SkeletonBuilder builder;
  for (Joint joint : plain->joints()) {
    if (WithProbability(random, 0.7)) {
      joint.link_mass_kg = Uniform(random, 0.1, 5);
    }
    joint.link_center_of_mass = RandomVector(random, 0.3);
    builder.AddJoint(joint);
  }
  return builder.Build().value();
}

// By the definition.
Eigen::Vector3d OracleCenter(const Skeleton& skeleton,
                             const Eigen::VectorXd& positions, bool equal) {
  const MatrixKinematicsOracle oracle(skeleton, positions);
  double mass = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const Joint& joint : skeleton.joints()) {
    const double m = equal ? 1 : joint.link_mass_kg;
    mass += m;
    moment += m * (oracle.WorldFromJoint(joint.id) *
                   joint.link_center_of_mass.homogeneous())
                      .head<3>();
  }
  return moment / mass;
}

Eigen::Vector3d CenterAt(const Skeleton& skeleton,
                         const Eigen::VectorXd& positions) {
  WorldTransforms frames;
  ForwardKinematics(skeleton, positions, frames);
  return CenterOfMass().Compute(skeleton, frames);
}

TEST(CenterOfMassTest, IsTheWeightedMean) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const auto skeleton = HeavySkeleton(random);
    const Eigen::VectorXd q = RandomPose(random, *skeleton);
    EXPECT_LE(
        (CenterAt(*skeleton, q) - OracleCenter(*skeleton, q, false)).norm(),
        kRounding);
  }
}

TEST(CenterOfMassTest, WithoutMassesAllAreEqual) {
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    const auto skeleton = RandomSkeletonBuilder(random, {}).Build().value();
    const Eigen::VectorXd q = RandomPose(random, *skeleton);
    EXPECT_LE(
        (CenterAt(*skeleton, q) - OracleCenter(*skeleton, q, true)).norm(),
        kRounding);
  }
}

TEST(CenterOfMassTest, JacobianIsTheDerivativeOnRandomTrees) {
  Random random(3);
  for (int tree = 0; tree < 60; ++tree) {
    const auto skeleton = HeavySkeleton(random);
    const Eigen::VectorXd q = RandomPose(random, *skeleton);
    const int columns = skeleton->velocity_count();
    RowMajorMatrix got(3, columns);
    WorldTransforms frames;
    ForwardKinematics(*skeleton, q, frames);
    CenterOfMass center;
    center.Compute(*skeleton, frames);
    center.ComputeJacobian(*skeleton, q, frames, got);
    for (int c = 0; c < columns; ++c) {
      Eigen::VectorXd velocity = Eigen::VectorXd::Zero(columns);
      Eigen::VectorXd ahead = q, behind = q;
      velocity[c] = kStep;
      Integrate(*skeleton, q, velocity, ahead);
      velocity[c] = -kStep;
      Integrate(*skeleton, q, velocity, behind);
      const Eigen::Vector3d want =
          (CenterAt(*skeleton, ahead) - CenterAt(*skeleton, behind)) /
          (2 * kStep);
      EXPECT_LE((got.col(c) - want).norm(), kDifferenceError);
    }
  }
}

}  // namespace
}  // namespace gelenk
