#include "gelenk/workspace/planar_annulus.h"

#include <gtest/gtest.h>

#include "gelenk/skeleton/planar_chain.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::PandaArm;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;

std::optional<PlanarAnnulus> ReachOfChain(const std::vector<double>& lengths) {
  PlanarChain chain;
  chain.link_lengths_m = lengths;
  chain.base = {1, 2};
  return ReachOf(*BuilderOf(chain)->Build().value(), "tip");
}

TEST(PlanarAnnulusTest, LongestLinkMinusTheOthersClippedAtZero) {
  const auto ring = ReachOfChain({5, 1, 2});
  ASSERT_TRUE(ring.has_value());
  EXPECT_DOUBLE_EQ(ring->inner_radius_m, 2);
  EXPECT_DOUBLE_EQ(ring->outer_radius_m, 8);
  EXPECT_EQ(ring->world_center, Eigen::Vector3d(1, 2, 0));
  EXPECT_EQ(ReachOfChain({3, 2, 2})->inner_radius_m, 0);
}

TEST(PlanarAnnulusTest, NoPoseLeavesIt) {
  Random random(1);
  PlanarChain chain;
  chain.link_lengths_m = {2, 0.5, 0.7};
  const auto skeleton = BuilderOf(chain)->Build().value();
  const auto ring = ReachOf(*skeleton, "tip");
  for (int i = 0; i < 1000; ++i) {
    const double r =
        EffectorPose(*skeleton, RandomPose(random, *skeleton), "tip")
            .translation.norm();
    EXPECT_GE(r, ring->inner_radius_m - 1e-12);
    EXPECT_LE(r, ring->outer_radius_m + 1e-12);
  }
}

TEST(PlanarAnnulusTest, NoneWithLimitsOtherJointsOrOtherAxes) {
  PlanarChain chain;
  chain.link_lengths_m = {1, 1};
  chain.movable_base = true;
  EXPECT_FALSE(ReachOf(*BuilderOf(chain)->Build().value(), "tip"));
  chain.movable_base = false;
  chain.limits.resize(2);
  chain.limits[1].lower = {-1};
  chain.limits[1].upper = {1};
  EXPECT_FALSE(ReachOf(*BuilderOf(chain)->Build().value(), "tip"));
  EXPECT_FALSE(ReachOf(*PandaArm(), "tip"));
  EXPECT_FALSE(ReachOf(*PandaArm(), "nose"));
}

}  // namespace
}  // namespace gelenk
