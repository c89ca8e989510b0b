#include "gelenk/skin/weighted_skin.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "gelenk/skin/mesh_around.h"
#include "tests/core/skin/mesh_checks.h"
#include "tests/core/skin/skin_chains.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::BallChain;
using ::gelenk::testing::BentPose;
using ::gelenk::testing::NormalsOf;
using ::gelenk::testing::PositionsOf;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomTransform;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::UniformIndex;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Floats of a figure of some 4 m.
constexpr double kFloatTolerance = 4e-6;

class WeightedSkinTest : public ::testing::TestWithParam<BlendMethod> {
 protected:
  WeightedSkinTest() {
    TubeShape tube;
    tube.length_m = 3;
    mesh_ = TubeMesh(tube).value();
  }

  std::shared_ptr<const Skin> Create(const SkinWeights& weights) const {
    WeightedSkin::Options options;
    options.method = GetParam();
    return WeightedSkin::Create(skeleton_, mesh_, weights, options).value();
  }

  SkinWeights RandomWeights(int influences) {
    SkinWeights weights;
    weights.influences_per_vertex = influences;
    for (size_t i = 0; i < influences * mesh_.positions.size(); ++i) {
      weights.joints.push_back(UniformIndex(random_, 3));
      weights.weights.push_back(Uniform(random_, 0.01, 3));
    }
    return weights;
  }

  Random random_{1};
  std::shared_ptr<const Skeleton> skeleton_ =
      BallChain(random_, {1, 1, 1}, 0.5);
  TriangleMesh mesh_;
  SkinWorkspace workspace_;
  VertexBlocks blocks_;
};

INSTANTIATE_TEST_SUITE_P(EachMethod, WeightedSkinTest,
                         ::testing::Values(BlendMethod::kLinear,
                                           BlendMethod::kDualQuaternion),
                         [](const auto& info) {
                           return info.param == BlendMethod::kLinear
                                      ? "linear"
                                      : "dual_quaternion";
                         });

TEST_P(WeightedSkinTest, RestPoseGivesBackTheMeshWithAnyInfluences) {
  for (int influences = 1; influences <= kMaxInfluences; ++influences) {
    const auto skin = Create(RandomWeights(influences));
    skin->Deform(skeleton_->rest_positions(), {}, workspace_, blocks_);
    const std::vector<Vector3d> got = PositionsOf(*skin, blocks_);
    const std::vector<Vector3d> normals = NormalsOf(*skin, blocks_);
    const std::vector<Vector3d> want_normals = VertexNormals(mesh_);
    for (size_t v = 0; v < got.size(); ++v) {
      EXPECT_LE((got[v] - mesh_.positions[v]).norm(), kFloatTolerance);
      EXPECT_LE((normals[v] - want_normals[v]).norm(), kFloatTolerance);
    }
  }
}

TEST_P(WeightedSkinTest, RigidPieceFollowsItsJoint) {
  const auto skin =
      Create(RigidWeights(static_cast<int>(mesh_.positions.size()), 2));
  const Eigen::VectorXd pose = BentPose(random_, *skeleton_, 2);
  const RigidTransform base = RandomTransform(random_, 1);
  WorldTransforms rest, bent;
  ForwardKinematics(*skeleton_, skeleton_->rest_positions(), rest);
  ForwardKinematics(*skeleton_, pose, base, bent);
  const RigidTransform motion = bent[2] * rest[2].Inverse();
  skin->Deform(pose, base, workspace_, blocks_);
  const std::vector<Vector3d> got = PositionsOf(*skin, blocks_);
  const std::vector<Vector3d> normals = NormalsOf(*skin, blocks_);
  const std::vector<Vector3d> rest_normals = VertexNormals(mesh_);
  for (size_t v = 0; v < got.size(); ++v) {
    EXPECT_LE((got[v] - motion * mesh_.positions[v]).norm(), kFloatTolerance);
    EXPECT_LE((normals[v] - motion.rotation * rest_normals[v]).norm(),
              kFloatTolerance);
  }
}

TEST_P(WeightedSkinTest, OrderOfInfluencesDoesNotMatter) {
  const SkinWeights weights = RandomWeights(4);
  SkinWeights reversed = weights;
  for (size_t i = 0; i < weights.joints.size(); i += 4) {
    for (int k = 0; k < 4; ++k) {
      reversed.joints[i + k] = weights.joints[i + 3 - k];
      reversed.weights[i + k] = weights.weights[i + 3 - k];
    }
  }
  const Eigen::VectorXd pose = BentPose(random_, *skeleton_, 0.7);
  const auto a = Create(weights);
  a->Deform(pose, {}, workspace_, blocks_);
  const std::vector<Vector3d> want = PositionsOf(*a, blocks_);
  const auto b = Create(reversed);
  b->Deform(pose, {}, workspace_, blocks_);
  const std::vector<Vector3d> got = PositionsOf(*b, blocks_);
  for (size_t v = 0; v < got.size(); ++v) {
    EXPECT_LE((got[v] - want[v]).norm(), kFloatTolerance);
  }
}

TEST_P(WeightedSkinTest, QuantisedIsWithinAStep) {
  const auto skin = Create(RandomWeights(4));
  const Eigen::VectorXd pose = BentPose(random_, *skeleton_, 0.7);
  QuantizedBlocks quantized;
  skin->DeformQuantized(pose, {}, workspace_, quantized);
  skin->Deform(pose, {}, workspace_, blocks_);
  const double step = quantized.box.size_m / 65535;
  for (int slot : skin->slots()) {
    EXPECT_LE((quantized.position(slot) - blocks_.position(slot).cast<double>())
                  .cwiseAbs()
                  .maxCoeff(),
              0.51 * step + kFloatTolerance);
  }
}

TEST(WeightedSkinErrorsTest, ListsWhatIsWrong) {
  Random random(2);
  const auto skeleton = BallChain(random, {1, 1});
  TubeShape tube;
  tube.rings = 1;
  tube.around = 3;
  const TriangleMesh mesh = TubeMesh(tube).value();
  const int count = static_cast<int>(mesh.positions.size());
  const auto refused = [&](const SkinWeights& weights,
                           const WeightedSkin::Options& options = {}) {
    return ViolationLines(
        WeightedSkin::Create(skeleton, mesh, weights, options).status());
  };
  SkinWeights weights = RigidWeights(count, 0);
  weights.influences_per_vertex = 9;
  EXPECT_THAT(refused(weights),
              ElementsAre("influences_per_vertex: want 1 to 8, got 9"));
  weights = RigidWeights(count, 0);
  weights.joints.pop_back();
  weights.weights.push_back(1);
  EXPECT_THAT(refused(weights), ElementsAre("joints: want 8 numbers, got 7",
                                            "weights: want 8 numbers, got 9"));
  weights = RigidWeights(count, 0);
  weights.joints[1] = 2;
  weights.weights[2] = std::nan("");
  EXPECT_THAT(refused(weights), ElementsAre("joints[1]: want 0 to 1, got 2",
                                            "weights[2]: want >= 0, got nan"));
  weights = RigidWeights(count, 0);
  weights.weights[3] = 0;
  EXPECT_THAT(refused(weights),
              ElementsAre("weights[3]: vertex 3: the sum is 0"));
  WeightedSkin::Options options;
  options.method = BlendMethod::kDualQuaternion;
  options.joint_from_mesh.assign(2, WeightedSkin::Affine::Identity());
  options.joint_from_mesh[1](0, 0) = 2;
  EXPECT_THAT(refused(RigidWeights(count, 0), options),
              ElementsAre(HasSubstr("joint_from_mesh[1]: is not rigid")));
}

// Matrices with a scale are fine for linear blending.
TEST(WeightedSkinErrorsTest, TakesInverseBindMatrices) {
  Random random(3);
  const auto skeleton = BallChain(random, {1, 1});
  TubeShape tube;
  const TriangleMesh mesh = TubeMesh(tube).value();
  WeightedSkin::Options options;
  options.joint_from_mesh.assign(2, 2 * WeightedSkin::Affine::Identity());
  const auto skin =
      WeightedSkin::Create(
          skeleton, mesh,
          RigidWeights(static_cast<int>(mesh.positions.size()), 0), options)
          .value();
  SkinWorkspace workspace;
  VertexBlocks blocks;
  skin->Deform(skeleton->rest_positions(), {}, workspace, blocks);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    EXPECT_LE((blocks.position(skin->slots()[v]).cast<double>() -
               2 * mesh.positions[v])
                  .norm(),
              kFloatTolerance);
    EXPECT_NEAR(blocks.normal(skin->slots()[v]).norm(), 1, kFloatTolerance);
  }
}

}  // namespace
}  // namespace gelenk
