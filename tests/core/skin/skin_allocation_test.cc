// A warm frame of a skin takes no memory.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "absl/functional/function_ref.h"
#include "gelenk/skin/example_shapes.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/nurbs_skin.h"
#include "gelenk/skin/weighted_skin.h"
#include "tests/testing/allocation_count.h"
#include "tests/testing/random_pose.h"

namespace gelenk {
namespace {

using ::gelenk::testing::AllocationCount;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPoseWithinLimits;

void ExpectWarmFramesTakeNothing(const Skin& skin) {
  Random random(1);
  std::vector<Eigen::VectorXd> poses;
  for (int i = 0; i < 10; ++i) {
    poses.push_back(RandomPoseWithinLimits(random, skin.skeleton()));
  }
  SkinWorkspace workspace;
  workspace.parallel_for = [](int count, absl::FunctionRef<void(int)> part) {
    for (int i = 0; i < count; ++i) part(i);
  };
  VertexBlocks blocks;
  QuantizedBlocks quantized;
  int before = 0;
  for (size_t i = 0; i < poses.size(); ++i) {
    skin.Deform(poses[i], {}, workspace, blocks);
    skin.DeformQuantized(poses[i], {}, workspace, quantized);
    if (i == 0) before = AllocationCount();
  }
  EXPECT_EQ(AllocationCount(), before);
}

TEST(SkinAllocationTest, LayeredSkinWithMusclesAndBranches) {
  const SkinShape shape = MakeSkinShape("humanoid", 2000).value();
  SkinMuscles muscles;
  for (const char* link : {"left_thigh", "spine"}) {
    Muscle& muscle = muscles.muscles.emplace_back();
    muscle.id = muscle.link_id = link;
    muscle.mode = MuscleMode::kPreserveVolume;
  }
  Muscle& muscle = muscles.muscles.emplace_back();
  muscle.id = "biceps";
  muscle.link_id = "left_upper_arm";
  muscle.driver_joint_id = "left_forearm";
  muscle.gain_s = 0.3;
  muscles.fullness = {{"left_shank", 0.5}};
  const auto rig = VolumeRig::Create(shape.skeleton, {}, muscles).value();
  const auto skin = LayeredSkin::Bind(*rig, shape.mesh).value();
  EXPECT_FALSE(VerticesOf(skin->binding(), BindingClass::kBlend).empty());
  ExpectWarmFramesTakeNothing(*skin);
}

TEST(SkinAllocationTest, SkinsInParts) {
  const SkinShape shape =
      MakeSkinShape("humanoid", kParallelVertices * 6 / 5).value();
  const auto rig = VolumeRig::Create(shape.skeleton).value();
  const auto skin = LayeredSkin::Bind(*rig, shape.mesh).value();
  ASSERT_GE(skin->vertex_count(), kParallelVertices);
  ExpectWarmFramesTakeNothing(*skin);
}

TEST(SkinAllocationTest, WeightedSkins) {
  const SkinShape shape = MakeSkinShape("arm", 500).value();
  WeightedSkin::Options options;
  for (BlendMethod method :
       {BlendMethod::kLinear, BlendMethod::kDualQuaternion}) {
    options.method = method;
    const int count = static_cast<int>(shape.mesh.positions.size());
    ExpectWarmFramesTakeNothing(
        *WeightedSkin::Create(shape.skeleton, shape.mesh,
                              RigidWeights(count, 1), options)
             .value());
  }
}

TEST(SkinAllocationTest, NurbsSkin) {
  const SkinShape shape = MakeSkinShape("cylinder", 100).value();
  // A flat sheet along the bones.
  NurbsSurface sheet;
  sheet.u = {1, {0, 0, 1, 1}};
  sheet.v = {3, {0, 0, 0, 0, 1, 1, 1, 1}};
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 4; ++j) {
      sheet.points.emplace_back(2 * j / 3.0, 0.2 * i - 0.1, 0.05);
      sheet.weights.push_back(1 + 0.1 * j);
    }
  }
  const auto rig = VolumeRig::Create(shape.skeleton).value();
  ExpectWarmFramesTakeNothing(*NurbsSkin::Create(*rig, sheet).value());
}

}  // namespace
}  // namespace gelenk
