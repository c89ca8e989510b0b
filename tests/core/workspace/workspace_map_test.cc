#include "gelenk/workspace/workspace_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gelenk/skeleton/planar_chain.h"
#include "gelenk/workspace/planar_annulus.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::PandaArm;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::shared_ptr<const Skeleton> Chain() {
  PlanarChain chain;
  chain.link_lengths_m = {2, 0.7};
  return BuilderOf(chain)->Build().value();
}

TEST(WorkspaceMapTest, FillsTheRingAndNothingElse) {
  WorkspaceOptions options;
  options.voxel_size_m = 0.1;
  options.sample_count = 50000;
  const WorkspaceMap map = MapWorkspace(*Chain(), "tip", options).value();
  const PlanarAnnulus ring = *ReachOf(*Chain(), "tip");
  EXPECT_EQ(map.size.z(), 1);
  int64_t counted = 0;
  for (const ReachedVoxel& voxel : map.voxels) {
    const double r = map.CenterOf(voxel).head<2>().norm();
    // A voxel is reached by any of its points.
    EXPECT_GE(r, ring.inner_radius_m - 0.1);
    EXPECT_LE(r, ring.outer_radius_m + 0.1);
    counted += voxel.reach_count;
    // Of two links, l1 l2 |sin(p2)|.
    EXPECT_LE(voxel.mean_manipulability, 2 * 0.7 + 1e-12);
    EXPECT_GT(voxel.mean_manipulability, 0);
  }
  EXPECT_EQ(counted, options.sample_count);
  // The ring's area in voxels, its edges counted half.
  const double area = M_PI * (2.7 * 2.7 - 1.3 * 1.3) / 0.01;
  EXPECT_NEAR(static_cast<double>(map.voxels.size()), area, 0.12 * area);
  EXPECT_EQ(map.PointCloud().cols(), static_cast<int>(map.voxels.size()));
}

TEST(WorkspaceMapTest, TheSameSeedGivesTheSameMap) {
  WorkspaceOptions options;
  options.sample_count = 2000;
  const auto arm = PandaArm();
  const WorkspaceMap first = MapWorkspace(*arm, "tip", options).value();
  const WorkspaceMap second = MapWorkspace(*arm, "tip", options).value();
  options.seed = 1;
  const WorkspaceMap other = MapWorkspace(*arm, "tip", options).value();
  EXPECT_EQ(first.PointCloud(), second.PointCloud());
  EXPECT_NE(first.world_min, other.world_min);
  // Unless told, the largest extent has 64 voxels (and one for its end).
  EXPECT_EQ(first.size.maxCoeff(), 65);
}

TEST(WorkspaceMapTest, NamesEveryBadField) {
  WorkspaceOptions options;
  options.sample_count = 0;
  options.voxel_size_m = -1;
  EXPECT_THAT(
      ViolationLines(MapWorkspace(*PandaArm(), "nose", options).status()),
      ElementsAre(HasSubstr("end_effector_id: "), HasSubstr("sample_count: "),
                  HasSubstr("voxel_size_m: ")));
  options.sample_count = 100;
  options.voxel_size_m = 1e-6;
  EXPECT_THAT(
      ViolationLines(MapWorkspace(*PandaArm(), "tip", options).status()),
      ElementsAre(HasSubstr("voxel_size_m: want at most")));
}

}  // namespace
}  // namespace gelenk
