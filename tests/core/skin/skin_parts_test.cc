// Large skins are deformed in parts, on threads that somebody lends.
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <thread>
#include <vector>

#include "gelenk/base/parallel_for.h"
#include "gelenk/skin/example_shapes.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/weighted_skin.h"
#include "tests/testing/random_pose.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPoseWithinLimits;

// Four threads, the last part first; counts the loops.
ParallelFor FourThreads(int* loops) {
  return [loops](int count, absl::FunctionRef<void(int)> part) {
    ++*loops;
    constexpr int kThreads = 4;
    std::vector<std::thread> threads;
    for (int k = 0; k < kThreads; ++k) {
      threads.emplace_back([=] {
        for (int i = count - 1 - k; i >= 0; i -= kThreads) part(i);
      });
    }
    for (std::thread& thread : threads) thread.join();
  };
}

struct Frames {
  VertexBlocks blocks;
  QuantizedBlocks quantized;
};

Frames FramesOf(const Skin& skin, const Eigen::VectorXd& pose,
                const ParallelFor& parallel_for) {
  SkinWorkspace workspace;
  workspace.parallel_for = parallel_for;
  Frames frames;
  skin.Deform(pose, {}, workspace, frames.blocks);
  skin.DeformQuantized(pose, {}, workspace, frames.quantized);
  return frames;
}

// How many loops ran in parts.
int ExpectSameBits(const Skin& skin) {
  Random random(3);
  int loops = 0;
  for (int i = 0; i < 3; ++i) {
    const Eigen::VectorXd pose =
        RandomPoseWithinLimits(random, skin.skeleton());
    const Frames want = FramesOf(skin, pose, nullptr);
    const Frames got = FramesOf(skin, pose, FourThreads(&loops));
    EXPECT_EQ(std::memcmp(got.blocks.data(), want.blocks.data(),
                          sizeof(float) * kernel::kBlockFloats *
                              static_cast<size_t>(skin.block_count())),
              0);
    EXPECT_EQ(std::memcmp(got.quantized.data(), want.quantized.data(),
                          kernel::kQuantizedBlockBytes *
                              static_cast<size_t>(skin.block_count())),
              0);
  }
  return loops;
}

SkinShape LargeHumanoid() {
  return MakeSkinShape("humanoid", kParallelVertices * 6 / 5).value();
}

TEST(SkinPartsTest, LayeredSkinsGiveTheSameBits) {
  const SkinShape shape = LargeHumanoid();
  ASSERT_GE(shape.mesh.positions.size(), size_t{kParallelVertices});
  const auto skin =
      LayeredSkin::Bind(*VolumeRig::Create(shape.skeleton).value(), shape.mesh)
          .value();
  // With vertices that several volumes share, in parts of their own.
  EXPECT_GT(VerticesOf(skin->binding(), BindingClass::kBlend).size(),
            2 * kSingleVerticesPerPart);
  EXPECT_GT(ExpectSameBits(*skin), 0);
}

TEST(SkinPartsTest, WeightedSkinsGiveTheSameBits) {
  const SkinShape shape = LargeHumanoid();
  const int count = static_cast<int>(shape.mesh.positions.size());
  for (BlendMethod method :
       {BlendMethod::kLinear, BlendMethod::kDualQuaternion}) {
    WeightedSkin::Options options;
    options.method = method;
    EXPECT_GT(
        ExpectSameBits(*WeightedSkin::Create(shape.skeleton, shape.mesh,
                                             RigidWeights(count, 1), options)
                            .value()),
        0);
  }
}

TEST(SkinPartsTest, SmallSkinsStayOnTheCallersThread) {
  const SkinShape shape =
      MakeSkinShape("cylinder", kParallelVertices * 9 / 10).value();
  const auto skin =
      LayeredSkin::Bind(*VolumeRig::Create(shape.skeleton).value(), shape.mesh)
          .value();
  ASSERT_LT(skin->vertex_count(), kParallelVertices);
  ASSERT_GT(skin->vertex_count(), 2 * kVerticesPerPart);
  EXPECT_EQ(ExpectSameBits(*skin), 0);
}

}  // namespace
}  // namespace gelenk
