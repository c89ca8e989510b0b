#include "gelenk/skin/layered_skin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/ik/instruction_set.h"
#include "gelenk/skin/example_shapes.h"
#include "gelenk/skin/mesh_around.h"
#include "tests/core/skin/mesh_checks.h"
#include "tests/core/skin/skin_chains.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::BentPose;
using ::gelenk::testing::ElbowAt;
using ::gelenk::testing::Fails;
using ::gelenk::testing::NormalsOf;
using ::gelenk::testing::PositionsOf;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomTransform;
using ::gelenk::testing::TwoLinkArm;
using ::gelenk::testing::Uniform;

// Of the size of the figure: 24 bits, some ten operations.
constexpr double kFloatTolerance = 1e-6;

// A shape bound to its volumes, and a pose of it.
struct Figure {
  SkinShape shape;
  std::shared_ptr<const LayeredSkin> skin;

  explicit Figure(absl::string_view name, int vertex_count = 3000)
      : shape(MakeSkinShape(name, vertex_count).value()) {
    const auto rig =
        VolumeRig::Create(shape.skeleton, shape.links, shape.muscles).value();
    skin = LayeredSkin::Bind(*rig, shape.mesh).value();
  }

  // Every joint turned by up to `size_rad` about any axis.
  Eigen::VectorXd Pose(Random& random, double size_rad) const {
    const Eigen::VectorXd velocity =
        size_rad * testing::RandomVelocity(random, *shape.skeleton, 1);
    Eigen::VectorXd positions = shape.skeleton->rest_positions();
    Integrate(*shape.skeleton, shape.skeleton->rest_positions(), velocity,
              positions);
    return positions;
  }
};

std::vector<Vector3d> Exactly(const LayeredSkin& skin,
                              const Eigen::VectorXd& pose,
                              std::vector<Vector3d>* normals = nullptr,
                              const RigidTransform& base = {}) {
  VolumeFrame frame;
  skin.rig().Evaluate(pose, base, frame);
  std::vector<Vector3d> positions;
  skin.DeformExactly(frame, positions, normals);
  return positions;
}

class LayeredSkinTest : public ::testing::TestWithParam<absl::string_view> {};

INSTANTIATE_TEST_SUITE_P(EachShape, LayeredSkinTest,
                         ::testing::ValuesIn(SkinShapeNames()),
                         [](const auto& info) {
                           return std::string(info.param);
                         });

TEST_P(LayeredSkinTest, RestPoseGivesBackTheMesh) {
  const Figure figure(GetParam());
  std::vector<Vector3d> normals;
  const std::vector<Vector3d> positions =
      Exactly(*figure.skin, figure.shape.skeleton->rest_positions(), &normals);
  const std::vector<Vector3d> want_normals = VertexNormals(figure.shape.mesh);
  for (size_t v = 0; v < positions.size(); ++v) {
    EXPECT_LE((positions[v] - figure.shape.mesh.positions[v]).norm(), 1e-12);
    EXPECT_LE((normals[v] - want_normals[v]).norm(), 1e-9);
  }
}

TEST_P(LayeredSkinTest, RigidMotionMovesItRigidly) {
  Random random(1);
  const Figure figure(GetParam());
  const RigidTransform motion = RandomTransform(random, 2);
  const std::vector<Vector3d> positions = Exactly(
      *figure.skin, figure.shape.skeleton->rest_positions(), nullptr, motion);
  for (size_t v = 0; v < positions.size(); ++v) {
    EXPECT_LE((positions[v] - motion * figure.shape.mesh.positions[v]).norm(),
              1e-12);
  }
}

TEST_P(LayeredSkinTest, KernelAgreesWithDoublePrecision) {
  Random random(2);
  const Figure figure(GetParam());
  SkinWorkspace workspace;
  VertexBlocks blocks;
  for (int k = 0; k < 5; ++k) {
    const Eigen::VectorXd pose = figure.Pose(random, 0.8);
    std::vector<Vector3d> want_normals;
    const std::vector<Vector3d> want =
        Exactly(*figure.skin, pose, &want_normals);
    double size = 0;
    for (const Vector3d& p : want) size = std::max(size, p.norm());
    figure.skin->Deform(pose, {}, workspace, blocks);
    const std::vector<Vector3d> got = PositionsOf(*figure.skin, blocks);
    const std::vector<Vector3d> normals = NormalsOf(*figure.skin, blocks);
    for (size_t v = 0; v < want.size(); ++v) {
      EXPECT_LE((got[v] - want[v]).norm(), kFloatTolerance * size);
      // Differences of products, short where the pose nearly folds.
      EXPECT_LE((normals[v] - want_normals[v]).norm(), 1e-4);
    }
  }
}

TEST_P(LayeredSkinTest, QuantisedIsWithinAStep) {
  Random random(3);
  const Figure figure(GetParam());
  SkinWorkspace workspace;
  QuantizedBlocks blocks;
  for (int k = 0; k < 5; ++k) {
    const Eigen::VectorXd pose = figure.Pose(random, 0.8);
    const RigidTransform base = RandomTransform(random, 2);
    std::vector<Vector3d> normals;
    const std::vector<Vector3d> want =
        Exactly(*figure.skin, pose, &normals, base);
    figure.skin->DeformQuantized(pose, base, workspace, blocks);
    const double step = blocks.box.size_m / 65535;
    EXPECT_LT(step, 1e-4);
    for (size_t v = 0; v < want.size(); ++v) {
      const int slot = figure.skin->slots()[v];
      // Half a step, and the rounding of the kernel.
      EXPECT_LE((blocks.position(slot) - want[v]).cwiseAbs().maxCoeff(),
                0.51 * step + 2e-6);
      EXPECT_LE(std::acos(std::min(1.0, blocks.normal(slot).dot(normals[v]))),
                kOctahedralErrorRad);
    }
  }
}

// The normal of a vertex against finite differences of the whole map, by
// binding points beside it.
TEST_P(LayeredSkinTest, NormalsAreThoseOfTheDeformedSurface) {
  Random random(4);
  const Figure figure(GetParam(), 500);
  const Eigen::VectorXd pose = figure.Pose(random, 0.4);
  const std::vector<Vector3d> rest_normals = VertexNormals(figure.shape.mesh);
  constexpr double kStep = 1e-5;
  std::vector<Vector3d> moved[2][2];
  for (int k = 0; k < 2; ++k) {
    for (int sign = 0; sign < 2; ++sign) {
      TriangleMesh beside = figure.shape.mesh;
      beside.normals = rest_normals;
      for (size_t v = 0; v < beside.positions.size(); ++v) {
        const Vector3d first = rest_normals[v].unitOrthogonal();
        const Vector3d tangent =
            k == 0 ? first : Vector3d(rest_normals[v].cross(first));
        beside.positions[v] += (sign == 0 ? kStep : -kStep) * tangent;
      }
      const auto binding = std::make_shared<const SkinBinding>(
          BindMesh(figure.skin->rig(), beside).value());
      const auto rig =
          figure.skin->rig().WithMuscles(figure.shape.muscles).value();
      const auto skin = LayeredSkin::Create(rig, beside, binding).value();
      moved[k][sign] = Exactly(*skin, pose);
      // The same side of every border of classes, or differences mean nothing.
      for (size_t v = 0; v < beside.positions.size(); ++v) {
        if (binding->vertices[v].link !=
            figure.skin->binding().vertices[v].link) {
          moved[k][sign][v].setConstant(std::nan(""));
        }
      }
    }
  }
  std::vector<Vector3d> normals;
  Exactly(*figure.skin, pose, &normals);
  int compared = 0;
  for (size_t v = 0; v < normals.size(); ++v) {
    const Vector3d want = (moved[0][0][v] - moved[0][1][v])
                              .cross(moved[1][0][v] - moved[1][1][v]);
    if (!want.allFinite() || want.norm() < 0.1 * kStep * kStep) continue;
    ++compared;
    // The map is C1: where its curvature jumps, differences are off by the step
    // times that.
    EXPECT_LE((normals[v] - want.normalized()).norm(), 1e-3) << v;
  }
  EXPECT_GT(compared, 0.9 * normals.size());
}

TEST(LayeredSkinLevelsTest, EveryInstructionSetGivesTheSame) {
  Random random(5);
  constexpr int kBlocks = 5;
  std::vector<kernel::VolumeCoefficients> volumes(2);
  for (auto& volume : volumes) {
    for (auto& power : volume.powers) {
      for (float& number : power) {
        number = static_cast<float>(Uniform(random, -1, 1));
      }
    }
  }
  VertexBlocks in;
  in.Resize(kBlocks);
  for (int i = 0; i < kBlocks * kernel::kBlockFloats; ++i) {
    in.data()[i] = static_cast<float>(Uniform(random, 0, 1));
  }
  const kernel::VolumeRun runs[] = {{1, 0, 2}, {0, 2, kBlocks}};
  const kernel::DeformLayout layout = {volumes.data(), runs, 2, in.data()};
  const kernel::QuantizationGrid grid = {{-1, -1, -1}, 20000};
  VertexBlocks want;
  want.Resize(kBlocks);
  DeformFunctionsFor(InstructionSet::kBaseline).deform(layout, want.data());
  for (InstructionSet level : SupportedInstructionSets()) {
    const kernel::DeformFunctions& functions = DeformFunctionsFor(level);
    VertexBlocks got;
    got.Resize(kBlocks);
    functions.deform(layout, got.data());
    QuantizedBlocks fused, apart;
    fused.Resize(kBlocks);
    apart.Resize(kBlocks);
    functions.deform_quantized(layout, grid, fused.data());
    functions.quantize(got.data(), kBlocks, grid, apart.data());
    for (int slot = 0; slot < kBlocks * kVerticesPerBlock; ++slot) {
      EXPECT_LE((got.position(slot) - want.position(slot)).norm(), 1e-5);
      EXPECT_LE((got.normal(slot) - want.normal(slot)).norm(), 1e-4);
      EXPECT_NEAR(got.normal(slot).norm(), 1, 1e-6);
    }
    // Fused or apart: but for ties of rounding the same steps.
    for (int i = 0; i < kBlocks; ++i) {
      const auto* a = reinterpret_cast<const uint16_t*>(
          fused.data() + i * kernel::kQuantizedBlockBytes);
      const auto* b = reinterpret_cast<const uint16_t*>(
          apart.data() + i * kernel::kQuantizedBlockBytes);
      for (int k = 0; k < 3 * kVerticesPerBlock; ++k) {
        EXPECT_LE(std::abs(a[k] - b[k]), 1);
      }
    }
  }
}

TEST(QuantizedBlocksTest, WallsOfTheBoxHold) {
  VertexBlocks blocks;
  blocks.Resize(1);
  blocks.Set(0, {-5, 0.5f, 7}, {0, 0, -1});
  blocks.Set(1, {0, 1, 0.25f}, {-0.6f, 0, 0.8f});
  blocks.Set(2, {1e30f, -1e30f, 0}, {0, 0, 0});
  QuantizedBlocks out;
  out.Resize(1);
  for (InstructionSet level : SupportedInstructionSets()) {
    DeformFunctionsFor(level).quantize(blocks.data(), 1, GridOf(out.box),
                                       out.data());
    EXPECT_LE((out.position(0) - Vector3d(0, 0.5, 1)).norm(), 1e-4);
    EXPECT_LE((out.position(1) - Vector3d(0, 1, 0.25)).norm(), 1e-4);
    EXPECT_LE((out.position(2) - Vector3d(1, 0, 0)).norm(), 1e-4);
    EXPECT_LE((out.normal(0) - Vector3d(0, 0, -1)).norm(), 1e-2);
    EXPECT_LE((out.normal(1) - Vector3d(-0.6, 0, 0.8)).norm(), 1e-2);
  }
}

// Every octahedral code is some direction, and comes back as itself.
TEST(QuantizedBlocksTest, NormalsOfAllDirectionsComeBack) {
  Random random(6);
  VertexBlocks blocks;
  blocks.Resize(100);
  std::vector<Vector3d> normals;
  for (int slot = 0; slot < 1600; ++slot) {
    normals.push_back(testing::RandomDirection(random));
    blocks.Set(slot, Eigen::Vector3f::Zero(), normals.back().cast<float>());
  }
  QuantizedBlocks out;
  out.Resize(100);
  DeformFunctionsFor(BestInstructionSet())
      .quantize(blocks.data(), 100, GridOf(out.box), out.data());
  for (int slot = 0; slot < 1600; ++slot) {
    EXPECT_LE((out.normal(slot) - normals[slot]).norm(), kOctahedralErrorRad);
  }
}

TEST(LayeredSkinErrorsTest, MaliciousMeshesAreRefused) {
  const auto rig = VolumeRig::Create(TwoLinkArm(Vector3d::UnitZ())).value();
  const auto refused = [&](const TriangleMesh& mesh) {
    return LayeredSkin::Bind(*rig, mesh).status();
  };
  const auto code = absl::StatusCode::kInvalidArgument;
  TubeShape tube;
  tube.length_m = 2;
  const TriangleMesh good = TubeMesh(tube).value();
  EXPECT_THAT(refused({}), Fails(code, "positions: want 1 to 1048576"));
  TriangleMesh bad = good;
  bad.triangles[7][1] = static_cast<int>(good.positions.size());
  bad.triangles[8][2] = -1;
  EXPECT_THAT(refused(bad), Fails(code, "triangles[7]: want indices below"));
  EXPECT_THAT(refused(bad), Fails(code, "triangles[8]"));
  bad = good;
  bad.positions[3].y() = std::nan("");
  EXPECT_THAT(refused(bad), Fails(code, "positions[3]"));
  bad.positions[3].y() = 1e300;
  EXPECT_THAT(refused(bad), Fails(code, "positions[3]"));
  bad = good;
  bad.normals = {Vector3d::UnitX()};
  EXPECT_THAT(refused(bad), Fails(code, "normals: want none or"));
  bad.normals.assign(good.positions.size(), Vector3d::Zero());
  EXPECT_THAT(refused(bad), Fails(code, "normals[0]: is zero"));
  bad = good;
  bad.positions.resize((1 << 20) + 1, Vector3d::Zero());
  EXPECT_THAT(refused(bad), Fails(code, "got 1048577"));
}

TEST(LayeredSkinErrorsTest, BindingOfAnotherMeshIsRefused) {
  const Figure arm("arm", 500);
  TriangleMesh other = arm.shape.mesh;
  other.positions.push_back(Vector3d::Zero());
  const auto rig = VolumeRig::Create(arm.shape.skeleton).value();
  const auto binding = std::make_shared<const SkinBinding>(arm.skin->binding());
  EXPECT_FALSE(LayeredSkin::Create(rig, other, binding).ok());
  SkinBinding broken = arm.skin->binding();
  broken.vertices[5].volume = 1000;
  EXPECT_THAT(LayeredSkin::Create(rig, arm.shape.mesh,
                                  std::make_shared<const SkinBinding>(broken))
                  .status(),
              Fails(absl::StatusCode::kInvalidArgument, "vertices[5]"));
}

// Vertices without triangles, triangles without area, points far off the
// bones: all are bound, and all stay finite.
TEST(LayeredSkinTest, PoorMeshesAreTakenAsTheyAre) {
  Random random(7);
  TriangleMesh mesh;
  for (int i = 0; i < 200; ++i) {
    mesh.positions.push_back(testing::RandomVector(random, 3));
  }
  mesh.triangles = {{0, 0, 0}, {1, 2, 1}, {3, 4, 5}};
  const auto arm = TwoLinkArm(Vector3d::UnitZ());
  const auto skin =
      LayeredSkin::Bind(*VolumeRig::Create(arm).value(), mesh).value();
  const std::vector<Vector3d> rest = Exactly(*skin, ElbowAt(*arm, 0));
  SkinWorkspace workspace;
  VertexBlocks blocks;
  skin->Deform(ElbowAt(*arm, 2), {}, workspace, blocks);
  for (size_t v = 0; v < rest.size(); ++v) {
    EXPECT_LE((rest[v] - mesh.positions[v]).norm(), 1e-12);
    EXPECT_TRUE(blocks.position(skin->slots()[v]).allFinite());
    EXPECT_TRUE(blocks.normal(skin->slots()[v]).allFinite());
  }
}

TEST(LayeredSkinTest, SlotsAreTheVertices) {
  const Figure figure("humanoid", 2000);
  std::vector<bool> taken(figure.skin->block_count() * kVerticesPerBlock);
  for (int slot : figure.skin->slots()) {
    ASSERT_LT(slot, static_cast<int>(taken.size()));
    EXPECT_FALSE(taken[slot]);
    taken[slot] = true;
  }
  EXPECT_GT(figure.skin->ByteSize(),
            figure.shape.mesh.positions.size() * sizeof(Vector3d));
}

}  // namespace
}  // namespace gelenk
