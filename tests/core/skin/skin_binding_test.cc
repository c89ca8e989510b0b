#include "gelenk/skin/skin_binding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/skeleton/skeleton_builder.h"
#include "gelenk/skin/example_shapes.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/mesh_around.h"
#include "gelenk/skin/section_fit.h"
#include "gelenk/skin/vertex_placement.h"
#include "tests/core/skin/mesh_checks.h"
#include "tests/core/skin/skin_chains.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::BentPose;
using ::gelenk::testing::PelvisWithLeg;
using ::gelenk::testing::Random;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Bound {
  SkinShape shape;
  std::shared_ptr<const VolumeRig> rig;
  SkinBinding binding;

  explicit Bound(absl::string_view name, int vertex_count = 8000)
      : shape(MakeSkinShape(name, vertex_count).value()),
        rig(FitSections(*VolumeRig::Create(shape.skeleton).value(),
                        shape.mesh)),
        binding(BindMesh(*rig, shape.mesh).value()) {}

  int count(BindingClass binding_class) const {
    return static_cast<int>(VerticesOf(binding, binding_class).size());
  }
};

// Whether a vertex of the limb of `joint_id` may go with `link`: with its own
// bone or, as where hip and thigh begin is anyone's guess, one next to it.
bool IsPlausible(const VolumeRig& rig, const std::string& joint_id, int link) {
  const int own = rig.FindLink(joint_id);
  return own == link || rig.link(own).parent == link ||
         rig.link(link).parent == own;
}

TEST(SkinBindingTest, CoordinatesGiveBackTheMesh) {
  for (absl::string_view name : SkinShapeNames()) {
    const Bound bound(name, 2000);
    for (size_t v = 0; v < bound.binding.vertices.size(); ++v) {
      const VertexBinding& vertex = bound.binding.vertices[v];
      EXPECT_LE((bound.rig->rest().volume(vertex.volume).Position(vertex.at) -
                 bound.shape.mesh.positions[v])
                    .norm(),
                1e-12);
      for (const BlendShare& share :
           bound.binding.SharesOf(static_cast<int>(v))) {
        EXPECT_LE((bound.rig->rest().volume(share.volume).Position(share.at) -
                   bound.shape.mesh.positions[v])
                      .norm(),
                  1e-12);
        EXPECT_GT(share.share, 0);
        EXPECT_LE(share.share, 1);
      }
    }
  }
}

TEST(SkinBindingTest, SimpleLimbsLeaveNoDoubt) {
  for (absl::string_view name : {"cylinder", "arm"}) {
    const Bound bound(name, 3000);
    EXPECT_EQ(bound.count(BindingClass::kAmbiguous), 0) << name;
    EXPECT_GT(bound.count(BindingClass::kUnique),
              0.9 * bound.binding.vertices.size())
        << name;
  }
}

// Arms beside the chest, legs beside each other.
TEST(SkinBindingTest, CloseLimbsAreToldApartOrFlagged) {
  const Bound bound("humanoid");
  const VertexPlacer placer(*bound.rig);
  const int count = static_cast<int>(bound.binding.vertices.size());
  int wrong = 0, wrong_in_silence = 0, wrong_by_distance = 0;
  for (int v = 0; v < count; ++v) {
    const std::string& joint_id = bound.shape.joint_ids[v];
    const VertexBinding& vertex = bound.binding.vertices[v];
    if (!IsPlausible(*bound.rig, joint_id,
                     placer.NearestLink(bound.shape.mesh.positions[v]))) {
      ++wrong_by_distance;
    }
    if (IsPlausible(*bound.rig, joint_id, vertex.link)) continue;
    ++wrong;
    if (vertex.binding_class == BindingClass::kUnique) ++wrong_in_silence;
  }
  // Measured: 2.8 % by distance, none here.
  EXPECT_GT(wrong_by_distance, 0.02 * count);
  EXPECT_LE(wrong, 0.001 * count);
  EXPECT_EQ(wrong_in_silence, 0);
  // Few are left to a person.
  EXPECT_LE(bound.count(BindingClass::kAmbiguous) +
                bound.count(BindingClass::kOutside),
            0.06 * count);
}

TEST(SkinBindingTest, ReportCountsEveryVertexOnce) {
  const Bound bound("humanoid");
  const BindingReport report =
      ReportOf(*bound.rig, bound.shape.mesh, bound.binding);
  int by_class = 0, by_link = 0;
  for (int k = 0; k < kBindingClassCount; ++k) {
    by_class += report.class_counts[k];
    for (const auto& counts : report.link_counts) by_link += counts[k];
    EXPECT_EQ(report.class_counts[k],
              bound.count(static_cast<BindingClass>(k)));
  }
  EXPECT_EQ(by_class, static_cast<int>(bound.binding.vertices.size()));
  EXPECT_EQ(by_link, by_class);
  EXPECT_GT(bound.count(BindingClass::kBlend), 0);
}

// Two arms so near to each other that their volumes hold each other's skin, in
// one mesh whose parts do not touch.
TEST(SkinBindingTest, FloodDecidesWhereVolumesOverlap) {
  SkeletonBuilder builder;
  Joint root;
  root.id = "root";
  root.type = JointType::kFree;
  builder.AddJoint(root);
  for (double side : {1, -1}) {
    Joint joint;
    joint.id = side > 0 ? "left" : "right";
    joint.parent_id = "root";
    joint.type = JointType::kSpherical;
    joint.parent_from_joint.translation = {0.5, 0.12 * side, 0};
    joint.link_length_m = 1;
    builder.AddJoint(joint);
  }
  const auto skeleton = builder.Build().value();
  SkinLinkOptions options;
  SkinLinkOverride own;
  own.joint_id = "root";
  own.continuation_joint_id = "";
  own.length_m = 0.1;
  options.overrides.push_back(own);
  for (const char* id : {"left", "right"}) {
    SkinLinkOverride arm;
    arm.joint_id = id;
    arm.half_extents_m = {0.16, 0.16};
    options.overrides.push_back(arm);
  }
  const auto rig = VolumeRig::Create(skeleton, options).value();
  TriangleMesh mesh;
  std::vector<int> want;
  for (double side : {1, -1}) {
    TubeShape tube;
    tube.radius_m = 0.1;
    const TriangleMesh arm = TubeMesh(tube).value();
    const int first = static_cast<int>(mesh.positions.size());
    for (const Vector3d& p : arm.positions) {
      mesh.positions.push_back(p + Vector3d(0.5, 0.12 * side, 0));
      want.push_back(rig->FindLink(side > 0 ? "left" : "right"));
    }
    for (const Triangle& t : arm.triangles) {
      mesh.triangles.push_back(t + Triangle::Constant(first));
    }
  }
  const SkinBinding binding = BindMesh(*rig, mesh).value();
  const std::vector<int> ambiguous =
      VerticesOf(binding, BindingClass::kAmbiguous);
  EXPECT_GT(ambiguous.size(), 100);
  for (int v : ambiguous) {
    const auto candidates = binding.CandidatesOf(v);
    ASSERT_EQ(candidates.size(), 2);
    EXPECT_LE(candidates[0].score, candidates[1].score);
  }
  for (size_t v = 0; v < want.size(); ++v) {
    // Rings at the joint may go to the stub's side of it.
    if (mesh.positions[v].x() < 0.51) continue;
    EXPECT_EQ(binding.vertices[v].link, want[v]);
  }
}

// Triangles that share no vertex, as some files write them.
TEST(SkinBindingTest, ASoupIsBoundAsItsMeshIs) {
  const Bound bound("humanoid", 3000);
  const TriangleMesh soup = testing::TriangleSoup(bound.shape.mesh);
  const SkinBinding binding = BindMesh(*bound.rig, soup).value();
  for (size_t i = 0; i < soup.triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const VertexBinding& corner = binding.vertices[soup.triangles[i][k]];
      const VertexBinding& want =
          bound.binding.vertices[bound.shape.mesh.triangles[i][k]];
      ASSERT_EQ(corner.volume, want.volume) << i;
      ASSERT_LE((bound.rig->rest().volume(corner.volume).Position(corner.at) -
                 soup.positions[soup.triangles[i][k]])
                    .norm(),
                1e-12);
    }
  }
  const BindingReport report = ReportOf(*bound.rig, soup, binding);
  EXPECT_EQ(report.stretched_edge_count,
            ReportOf(*bound.rig, bound.shape.mesh, bound.binding)
                .stretched_edge_count);
}

// A bump on a limb, beyond its section: nothing else is near. One far beyond
// is in doubt.
TEST(SkinBindingTest, ABumpIsItsLimbsWhenNoOtherIsNear) {
  const auto arm = testing::TwoLinkArm(Vector3d::UnitZ());
  TriangleMesh mesh = TubeMesh({2, 0.1, 40, 24}).value();
  const auto rig = FitSections(*VolumeRig::Create(arm).value(), mesh);
  const int bump = 10 * 24, spike = 30 * 24;
  mesh.positions[bump].y() *= 1.8;
  mesh.positions[spike].y() *= 4;
  const SkinBinding binding = BindMesh(*rig, mesh).value();
  EXPECT_EQ(binding.vertices[bump].binding_class, BindingClass::kUnique);
  EXPECT_EQ(binding.vertices[spike].binding_class, BindingClass::kOutside);
  EXPECT_NEAR(binding.vertices[spike].outside_m, 0.4 - 1.15 * 0.1, 0.01);
}

TEST(SkinBindingTest, EdgesBetweenStrangersAreNamed) {
  const Bound bound("humanoid");
  TriangleMesh mesh = bound.shape.mesh;
  // A thread from one hand to the other.
  int hands[2] = {-1, -1};
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    const std::string& id = bound.rig->link(bound.binding.vertices[v].link).id;
    if (id == "left_hand") hands[0] = static_cast<int>(v);
    if (id == "right_hand") hands[1] = static_cast<int>(v);
  }
  const int before =
      ReportOf(*bound.rig, mesh, bound.binding).stretched_edge_count;
  mesh.triangles.push_back({hands[0], hands[1], hands[0]});
  const BindingReport report = ReportOf(*bound.rig, mesh, bound.binding);
  EXPECT_EQ(report.stretched_edge_count, before + 1);
  bool named = false;
  for (const StretchedEdge& edge : report.stretched_edges) {
    named |= edge.vertices[0] == std::min(hands[0], hands[1]) &&
             edge.vertices[1] == std::max(hands[0], hands[1]);
  }
  EXPECT_TRUE(named);
}

// Near a branch the map has neither a tear nor a crease when the leg is raised:
// across the start of the stub, the plane of the joint, and both shells.
TEST(SkinBindingTest, SkinIsSmoothWhereALegBranchesOff) {
  const auto skeleton = PelvisWithLeg();
  SkinLinkOptions options;
  options.slenderness = 0.3;
  const auto rig = VolumeRig::Create(skeleton, options).value();
  Random random(1);
  const Eigen::VectorXd pose = BentPose(random, *skeleton, 0.8);
  VolumeFrame frame;
  rig->Evaluate(pose, {}, frame);
  const int thigh = rig->FindLink("thigh");
  const Vector3d joint = rig->rest().origin(thigh);
  const Vector3d down = rig->rest().rotation(thigh).col(0);
  const VertexPlacer placer(*rig);
  const auto deformed = [&](const Vector3d& point) {
    Placement placement = placer.InChain(point, rig->chain(0));
    std::vector<BlendShare> shares;
    placer.AddShares(point, placement, shares);
    double rest = 1;
    Vector3d sum = Vector3d::Zero();
    for (const BlendShare& share : shares) {
      sum += share.share * frame.volume(share.volume).Position(share.at);
      rest -= share.share;
    }
    return Vector3d(
        sum + rest * frame.volume(placement.volume).Position(placement.at));
  };
  constexpr double kStep = 1e-4;
  const auto expect_smooth = [&](const Vector3d& from, const Vector3d& way) {
    double longest = 0, crease = 0;
    Vector3d slope = (deformed(from + kStep * way) - deformed(from)) / kStep;
    for (double x = kStep; x < 0.9; x += kStep) {
      const Vector3d next =
          (deformed(from + (x + kStep) * way) - deformed(from + x * way)) /
          kStep;
      longest = std::max(longest, next.norm());
      crease = std::max(crease, (next - slope).norm());
      slope = next;
    }
    // A tear would be some hundred times as much, a crease ten times.
    EXPECT_LT(longest, 6);
    EXPECT_LT(crease, 0.03);
  };
  const Vector3d side = rig->rest().rotation(thigh).col(2);
  for (double across : {0.05, 0.2, 0.28, 0.35}) {
    expect_smooth(joint + across * side - 0.6 * down, down);
  }
  for (double along : {-0.3, -0.1, 0.1}) {
    expect_smooth(joint + along * down - 0.45 * side, side);
  }
}

TEST(SkinBindingTest, AssignmentsAreHonouredAndListed) {
  const Bound bound("arm", 1000);
  const std::vector<VertexAssignment> assignments = {
      {3, "hand"}, {3, "forearm", AssignmentScope::kLink}, {10, "upper_arm"}};
  const SkinBinding binding =
      BindMesh(*bound.rig, bound.shape.mesh, assignments).value();
  EXPECT_EQ(binding.vertices[3].binding_class, BindingClass::kUser);
  EXPECT_EQ(bound.rig->link(binding.vertices[3].link).id, "forearm");
  EXPECT_EQ(binding.vertices[10].binding_class, BindingClass::kUser);
  ASSERT_EQ(binding.assignments.size(), 2);
  // Exported and imported they make the same binding.
  const SkinBinding again =
      BindMesh(*bound.rig, bound.shape.mesh, binding.assignments).value();
  for (size_t v = 0; v < binding.vertices.size(); ++v) {
    EXPECT_EQ(again.vertices[v].volume, binding.vertices[v].volume);
    EXPECT_EQ(again.vertices[v].at.u, binding.vertices[v].at.u);
  }
}

// What was decided for a vertex holds for its twins, but those that somebody
// decided for themselves.
TEST(SkinBindingTest, TwinsFollowADecision) {
  const Bound bound("arm", 1000);
  TriangleMesh mesh = bound.shape.mesh;
  const int twin = static_cast<int>(mesh.positions.size());
  mesh.positions.push_back(mesh.positions[3]);
  mesh.positions.push_back(mesh.positions[3]);
  mesh.normals.push_back(mesh.normals[3]);
  mesh.normals.push_back(mesh.normals[3]);
  const auto link_id = [&](const SkinBinding& binding, int vertex) {
    return bound.rig->link(binding.vertices[vertex].link).id;
  };
  for (int decided : {3, twin}) {
    const SkinBinding binding =
        BindMesh(*bound.rig, mesh, {{decided, "hand", AssignmentScope::kLink}})
            .value();
    for (int vertex : {3, twin, twin + 1}) {
      EXPECT_EQ(link_id(binding, vertex), "hand");
      EXPECT_EQ(binding.vertices[vertex].binding_class, BindingClass::kUser);
    }
    EXPECT_EQ(binding.assignments.size(), 1);
  }
  const SkinBinding apart =
      BindMesh(*bound.rig, mesh,
               {{3, "hand", AssignmentScope::kLink},
                {twin, "upper_arm", AssignmentScope::kLink}})
          .value();
  EXPECT_EQ(link_id(apart, 3), "hand");
  EXPECT_EQ(link_id(apart, twin), "upper_arm");
  EXPECT_EQ(link_id(apart, twin + 1), "hand");
}

TEST(SkinBindingTest, ListsEveryBadAssignment) {
  const Bound bound("arm", 1000);
  EXPECT_THAT(
      testing::ViolationLines(BindMesh(*bound.rig, bound.shape.mesh,
                                       {{-1, "hand"}, {1 << 20, "tail"}})
                                  .status()),
      ElementsAre(HasSubstr("assignments[0].vertex: want 0 to"),
                  HasSubstr("assignments[1].vertex: want 0 to"),
                  "assignments[1].link_id: no link \"tail\""));
}

}  // namespace
}  // namespace gelenk
