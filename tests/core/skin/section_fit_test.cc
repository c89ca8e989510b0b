#include "gelenk/skin/section_fit.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "gelenk/skeleton/skeleton_builder.h"
#include "gelenk/skin/example_shapes.h"
#include "gelenk/skin/mesh_around.h"
#include "gelenk/skin/skin_binding.h"
#include "tests/core/skin/skin_chains.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

// A limb of few, long triangles, beside a fine one.
TEST(FitSectionsTest, SeesTheTrianglesOfACoarseLimbNotTheNextLimb) {
  const auto arm = gelenk::testing::TwoLinkArm(Vector3d::UnitZ());
  TriangleMesh mesh = TubeMesh({2, 0.1, 1, 16}).value();
  const TriangleMesh fine = TubeMesh({2, 0.1, 80, 64}).value();
  const int first = static_cast<int>(mesh.positions.size());
  for (const Vector3d& position : fine.positions) {
    mesh.positions.push_back(position + 0.7 * Vector3d::UnitY());
  }
  for (const Triangle& triangle : fine.triangles) {
    mesh.triangles.push_back(triangle.array() + first);
  }
  const auto rig = FitSections(*VolumeRig::Create(arm).value(), mesh);
  for (const SkinLink& link : rig->links()) {
    EXPECT_GE(link.half_extents_m.minCoeff(), 0.09) << link.id;
    EXPECT_LE(link.half_extents_m.maxCoeff(), 0.15) << link.id;
  }
}

TEST(FitSectionsTest, SectionsFitTheLimbs) {
  const SkinShape shape = MakeSkinShape("humanoid", 8000).value();
  const auto rig =
      FitSections(*VolumeRig::Create(shape.skeleton).value(), shape.mesh);
  const auto section = [&](const char* id) {
    return rig->link(rig->FindLink(id)).half_extents_m;
  };
  // The radii that the body is made of, and the margin; an arm does not count
  // for the hip beside it.
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(section("left_forearm")[k], 1.15 * 0.042, 0.007);
    EXPECT_NEAR(section("left_thigh")[k], 1.15 * 0.085, 0.015);
    EXPECT_NEAR(section("head")[k], 1.15 * 0.09, 0.02);
  }
}

// Joints "a", "b", .. along the points, the last with nothing beyond it.
std::shared_ptr<const Skeleton> BareChain(const std::vector<Vector3d>& points) {
  SkeletonBuilder builder;
  Vector3d before = Vector3d::Zero();
  for (size_t i = 0; i < points.size(); ++i) {
    Joint joint;
    joint.id = std::string(1, static_cast<char>('a' + i));
    if (i > 0) joint.parent_id = std::string(1, static_cast<char>('a' + i - 1));
    joint.type = JointType::kSpherical;
    joint.parent_from_joint.translation = points[i] - before;
    before = points[i];
    builder.AddJoint(joint);
  }
  return builder.Build().value();
}

int CountOf(const VolumeRig& rig, const TriangleMesh& mesh,
            BindingClass binding_class) {
  return static_cast<int>(
      VerticesOf(BindMesh(rig, mesh).value(), binding_class).size());
}

// A head is much longer than half a neck, which is what its joint says of it;
// and a body begins before its first joint.
TEST(FitSectionsTest, CapsReachAsFarAsTheSurface) {
  const auto skeleton = BareChain({{0.3, 0, 0}, {0.8, 0, 0}, {0.9, 0, 0}});
  const TriangleMesh mesh = TubeMesh({2, 0.1, 40, 24}).value();
  const auto rig = VolumeRig::Create(skeleton).value();
  const auto fitted = FitSections(*rig, mesh);
  EXPECT_NEAR(fitted->links().back().cap_reach_m[1], 1.15 * 1.05, 1e-6);
  EXPECT_NEAR(fitted->link(0).cap_reach_m[0], 1.15 * 0.3, 1e-6);
  EXPECT_GT(CountOf(*rig, mesh, BindingClass::kOutside), 0);
  EXPECT_EQ(CountOf(*fitted, mesh, BindingClass::kOutside), 0);
}

// A root on the ground and two legs beside it: it takes nothing of them.
TEST(FitSectionsTest, ABoneOutsideTheSurfaceCarriesNothing) {
  const auto skeleton = BareChain({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  TriangleMesh mesh = TubeMesh({1.2, 0.3, 20, 24}).value();
  for (Vector3d& position : mesh.positions) position.x() += 1;
  for (double side : {1, -1}) {
    const TriangleMesh leg = TubeMesh({0.9, 0.08, 20, 16}).value();
    const int first = static_cast<int>(mesh.positions.size());
    for (const Vector3d& position : leg.positions) {
      mesh.positions.push_back(position + 0.2 * side * Vector3d::UnitY());
    }
    for (const Triangle& triangle : leg.triangles) {
      mesh.triangles.push_back(triangle.array() + first);
    }
  }
  const auto fitted = FitSections(*VolumeRig::Create(skeleton).value(), mesh);
  EXPECT_LE(fitted->link(0).half_extents_m.maxCoeff(), 0.011);
  EXPECT_NEAR(fitted->link(1).half_extents_m.maxCoeff(), 1.15 * 0.3, 0.05);
}

}  // namespace
}  // namespace gelenk
