#include "gelenk/skeleton/planar_chain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gelenk/kinematics/forward_kinematics.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;

// The worked example in closed form.
TEST(PlanarChainTest, ForwardKinematics) {
  PlanarChain chain;
  chain.link_lengths_m = {4, 6, 2};
  const auto skeleton = BuilderOf(chain)->Build().value();
  const double root3 = std::sqrt(3);
  const Eigen::Vector3d points[] = {{0, 0, 0},
                                    {2, 2 * root3, 0},
                                    {2 + 3 * root3, 2 * root3 - 3, 0},
                                    {2 + 4 * root3, 2 * root3 - 2, 0}};
  WorldTransforms frames;
  ForwardKinematics(*skeleton, Eigen::Vector3d(M_PI / 3, 1.5 * M_PI, M_PI / 3),
                    frames);
  const EffectorFrame tip = *skeleton->FindEffector("tip");
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d point =
        i < 3 ? frames[i].translation
              : frames[tip.joint] * tip.joint_from_effector.translation;
    EXPECT_LT((point - points[i]).norm(), 1e-14);
  }
  EXPECT_EQ(skeleton->joint(1).link_length_m, 6);
}

TEST(PlanarChainTest, AMovableBaseHasTwoDegreesOfFreedomMore) {
  PlanarChain chain;
  chain.link_lengths_m = {1, 2};
  chain.base = {5, 6};
  EXPECT_EQ(BuilderOf(chain)->Build().value()->velocity_count(), 2);
  chain.movable_base = true;
  const auto skeleton = BuilderOf(chain)->Build().value();
  EXPECT_EQ(skeleton->velocity_count(), 4);
  WorldTransforms frames;
  ForwardKinematics(*skeleton, Eigen::Vector4d(0.5, 0.25, M_PI / 2, 0), frames);
  EXPECT_LT((frames[3].translation - Eigen::Vector3d(5.5, 7.25, 0)).norm(),
            1e-14);
}

TEST(PlanarChainTest, BranchesAreJointsLikeAnyOther) {
  PlanarChain chain;
  chain.link_lengths_m = {1, 2};
  SkeletonBuilder builder = BuilderOf(chain).value();
  Joint branch;
  branch.id = "branch";
  branch.parent_id = "j0";
  branch.type = JointType::kRevolute;
  branch.axis = Eigen::Vector3d::UnitZ();
  builder.AddJoint(branch);
  EXPECT_EQ(builder.Build().value()->velocity_count(), 3);
  branch.id = "out of the plane";
  branch.axis = Eigen::Vector3d::UnitX();
  builder.AddJoint(branch);
  EXPECT_FALSE(builder.Build().ok());
}

TEST(PlanarChainTest, Limits) {
  PlanarChain chain;
  chain.link_lengths_m = {1, 2};
  chain.limits.resize(2);
  chain.limits[1].lower = {-1};
  chain.limits[1].upper = {2};
  const auto skeleton = BuilderOf(chain)->Build().value();
  EXPECT_EQ(skeleton->position_bounds().lower[1], -1);
  EXPECT_EQ(skeleton->position_bounds().upper[1], 2);
}

TEST(PlanarChainTest, NamesEveryBadField) {
  PlanarChain chain;
  chain.link_lengths_m = {1, 0, -2};
  chain.base = {NAN, 0};
  chain.limits.resize(1);
  EXPECT_THAT(ViolationLines(BuilderOf(chain).status()),
              ElementsAre("link_lengths[1]: want a finite number > 0, got 0",
                          "link_lengths[2]: want a finite number > 0, got -2",
                          "base: want finite numbers, got (nan, 0)",
                          "limits: want none or 3, got 1"));
  EXPECT_THAT(ViolationLines(BuilderOf(PlanarChain()).status()),
              ElementsAre("link_lengths: want at least one"));
}

}  // namespace
}  // namespace gelenk
