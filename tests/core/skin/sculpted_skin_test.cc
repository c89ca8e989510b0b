#include "gelenk/skin/sculpted_skin.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <vector>

#include "gelenk/skin/control_net.h"
#include "gelenk/skin/mesh_around.h"
#include "tests/core/skin/mesh_checks.h"
#include "tests/core/skin/skin_chains.h"
#include "tests/testing/status_matchers.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::BallChain;
using ::gelenk::testing::BentPose;
using ::gelenk::testing::Fails;
using ::gelenk::testing::NormalsOf;
using ::gelenk::testing::PositionsOf;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomTransform;
using ::gelenk::testing::RandomVector;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr absl::StatusCode kBad = absl::StatusCode::kInvalidArgument;
// Floats of a figure of some 4 m.
constexpr double kFloatTolerance = 4e-6;

// Tiny triangles, apart, on a tube around three links: their own normals tell
// what the vertices' should be.
TriangleMesh Scales(const TriangleMesh& tube) {
  constexpr double kSize = 1e-3;
  TriangleMesh scales;
  for (const Triangle& triangle : tube.triangles) {
    const Vector3d& a = tube.positions[triangle[0]];
    const int first = static_cast<int>(scales.positions.size());
    scales.positions.push_back(a);
    for (int k : {1, 2}) {
      scales.positions.push_back(
          a + kSize * (tube.positions[triangle[k]] - a).normalized());
    }
    scales.triangles.emplace_back(first, first + 1, first + 2);
  }
  return scales;
}

class SculptedSkinTest : public ::testing::Test {
 protected:
  SculptedSkinTest() {
    TubeShape tube;
    tube.length_m = 3;
    tube.radius_m = 0.15;
    mesh_ = TubeMesh(tube).value();
    skin_ =
        LayeredSkin::Bind(*VolumeRig::Create(skeleton_).value(), mesh_).value();
  }

  SculptedPlane RandomPlane(const char* link_id, int plane, double size_m) {
    SculptedPlane sculpted;
    sculpted.link_id = link_id;
    sculpted.plane = plane;
    for (Vector3d& offset : sculpted.offsets_m) {
      offset = RandomVector(random_, size_m);
    }
    return sculpted;
  }

  std::vector<SculptedPlane> RandomPlanes(double size_m) {
    return {RandomPlane("j0", 4, size_m), RandomPlane("j1", 2, size_m),
            RandomPlane("j1", 4, size_m)};
  }

  Random random_{1};
  std::shared_ptr<const Skeleton> skeleton_ = BallChain(random_, {1, 1, 1});
  TriangleMesh mesh_;
  std::shared_ptr<const LayeredSkin> skin_;
  SkinWorkspace workspace_;
  VertexBlocks blocks_;
};

TEST_F(SculptedSkinTest, RestPoseGivesBackTheMesh) {
  const auto sculpted = SculptedSkin::Create(skin_, RandomPlanes(0.03));
  ASSERT_TRUE(sculpted.ok()) << sculpted.status();
  (*sculpted)->Deform(skeleton_->rest_positions(), {}, workspace_, blocks_);
  const std::vector<Vector3d> positions = PositionsOf(**sculpted, blocks_);
  const std::vector<Vector3d> normals = NormalsOf(**sculpted, blocks_);
  const std::vector<Vector3d> rest_normals = VertexNormals(mesh_);
  for (size_t v = 0; v < positions.size(); ++v) {
    EXPECT_LT((positions[v] - mesh_.positions[v]).norm(), kFloatTolerance);
    EXPECT_LT((normals[v] - rest_normals[v]).norm(), 10 * kFloatTolerance);
  }
}

TEST_F(SculptedSkinTest, WithoutOffsetsItIsTheLayeredSkin) {
  const auto sculpted = SculptedSkin::Create(skin_, RandomPlanes(0)).value();
  const Eigen::VectorXd pose = BentPose(random_, *skeleton_, 1);
  sculpted->Deform(pose, {}, workspace_, blocks_);
  const std::vector<Vector3d> got = PositionsOf(*sculpted, blocks_);
  skin_->Deform(pose, {}, workspace_, blocks_);
  const std::vector<Vector3d> want = PositionsOf(*skin_, blocks_);
  for (size_t v = 0; v < got.size(); ++v) {
    EXPECT_LT((got[v] - want[v]).norm(), kFloatTolerance);
  }
}

// Against the definition: the sum over 64 control points of sculpted nets, at
// the coordinates that the same sum has for the vertex at rest.
TEST_F(SculptedSkinTest, IsTheVolumeOfTheSculptedNets) {
  const SculptedPlane p2 = RandomPlane("j1", 2, 0.03);
  const SculptedPlane p4 = RandomPlane("j1", 4, 0.03);
  const auto sculpted =
      SculptedSkin::Create(skin_, std::vector<SculptedPlane>{p2, p4}).value();
  const VolumeRig& rig = skin_->rig();
  const Eigen::Vector2d half_extents = rig.link(1).half_extents_m;
  // The nets of one half of link 1.
  const auto nets_of = [&](const VolumeFrame& frame, bool is_first_half) {
    const auto planes = frame.planes(1);
    const ControlNet second =
        SculptedNet(planes[2], half_extents, p2.offsets_m);
    const ControlNet fourth =
        SculptedNet(planes[4], half_extents, p4.offsets_m);
    ControlNet third;
    for (int i = 0; i < 16; ++i) {
      third.points[i] = 0.5 * (second.points[i] + fourth.points[i]);
    }
    const auto plain = [&](int k) {
      return UniformNet(planes[k], half_extents);
    };
    return is_first_half
               ? std::vector<ControlNet>{plain(0), plain(1), second, third}
               : std::vector<ControlNet>{third, fourth, plain(5), plain(6)};
  };
  VolumeFrame frame;
  const Eigen::VectorXd pose = BentPose(random_, *skeleton_, 1);
  rig.Evaluate(pose, {}, frame);
  sculpted->Deform(pose, {}, workspace_, blocks_);
  const std::vector<Vector3d> got = PositionsOf(*sculpted, blocks_);
  int compared = 0;
  for (size_t v = 0; v < got.size(); ++v) {
    const VertexBinding& bound = skin_->binding().vertices[v];
    const VolumePart part = rig.volume_part(bound.volume);
    if (rig.volume_link(bound.volume) != 1 ||
        (part != VolumePart::kFirstHalf && part != VolumePart::kSecondHalf)) {
      continue;
    }
    const bool is_first_half = part == VolumePart::kFirstHalf;
    const std::vector<ControlNet> rest = nets_of(rig.rest(), is_first_half);
    // Coordinates by Newton on differences of the sum.
    Eigen::Vector3d at(bound.at.u, bound.at.s, bound.at.t);
    const auto sum = [&](const std::vector<ControlNet>& nets,
                         const Eigen::Vector3d& x) {
      return SumOfControlPoints(nets, half_extents, {x[0], x[1], x[2]});
    };
    for (int step = 0; step < 30; ++step) {
      Eigen::Matrix3d slopes;
      for (int k = 0; k < 3; ++k) {
        const Vector3d nudge = 1e-6 * Vector3d::Unit(k);
        slopes.col(k) = (sum(rest, at + nudge) - sum(rest, at - nudge)) / 2e-6;
      }
      at += slopes.inverse() * (mesh_.positions[v] - sum(rest, at));
    }
    EXPECT_LT((got[v] - sum(nets_of(frame, is_first_half), at)).norm(),
              kFloatTolerance)
        << v;
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST_F(SculptedSkinTest, NormalsAreThoseOfTheDeformedSurface) {
  const TriangleMesh scales = Scales(mesh_);
  const auto skin = LayeredSkin::Bind(skin_->rig(), scales).value();
  const auto sculpted = SculptedSkin::Create(skin, RandomPlanes(0.03)).value();
  sculpted->Deform(BentPose(random_, *skeleton_, 0.8), {}, workspace_, blocks_);
  TriangleMesh deformed;
  deformed.positions = PositionsOf(*sculpted, blocks_);
  deformed.triangles = scales.triangles;
  const std::vector<Vector3d> want = VertexNormals(deformed);
  const std::vector<Vector3d> got = NormalsOf(*sculpted, blocks_);
  for (size_t v = 0; v < got.size(); ++v) {
    // Triangles of 1 mm whose corners are floats.
    EXPECT_LT((got[v] - want[v]).norm(), 0.02) << v;
  }
}

TEST_F(SculptedSkinTest, RigidMotionMovesItRigidly) {
  const auto sculpted = SculptedSkin::Create(skin_, RandomPlanes(0.03)).value();
  const Eigen::VectorXd pose = BentPose(random_, *skeleton_, 1);
  sculpted->Deform(pose, {}, workspace_, blocks_);
  const std::vector<Vector3d> before = PositionsOf(*sculpted, blocks_);
  const RigidTransform motion = RandomTransform(random_, 1);
  sculpted->Deform(pose, motion, workspace_, blocks_);
  const std::vector<Vector3d> after = PositionsOf(*sculpted, blocks_);
  for (size_t v = 0; v < before.size(); ++v) {
    EXPECT_LT((motion * before[v] - after[v]).norm(), kFloatTolerance);
  }
}

TEST_F(SculptedSkinTest, ListsWhatIsMalformed) {
  std::vector<SculptedPlane> planes = RandomPlanes(0.01);
  planes[0].plane = 3;
  planes[1].link_id = "elbow";
  planes[2].offsets_m[5].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(ViolationLines(SculptedSkin::Create(skin_, planes).status()),
              ElementsAre("planes[0].plane: want 2 or 4, got 3",
                          "planes[1].link_id: there is no link \"elbow\"",
                          HasSubstr("planes[2].offsets_m[5]")));
  planes = {RandomPlane("j0", 2, 0.01), RandomPlane("j0", 2, 0.01)};
  EXPECT_THAT(SculptedSkin::Create(skin_, planes).status(),
              Fails(kBad, "planes[1]: is sculpted by planes[0] already"));
  planes.assign(7, RandomPlane("j0", 2, 0.01));
  EXPECT_THAT(SculptedSkin::Create(skin_, planes).status(),
              Fails(kBad, "want at most 6, got 7"));
  EXPECT_THAT(SculptedSkin::Create(skin_, RandomPlanes(3)).status(),
              Fails(kBad, "inside out"));
}

}  // namespace
}  // namespace gelenk
