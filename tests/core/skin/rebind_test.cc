#include "gelenk/skin/rebind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/skin/example_shapes.h"
#include "gelenk/skin/mesh_around.h"
#include "tests/core/skin/skin_chains.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::TwoLinkArm;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A tube of two links, r = 0.1 m; a small one apart from it, above the first
// link.
class RebindTest : public ::testing::Test {
 protected:
  RebindTest() {
    TubeShape tube;
    tube.length_m = 2;
    mesh_ = TubeMesh(tube).value();
    tube_vertices_ = static_cast<int>(mesh_.positions.size());
    tube.length_m = 0.2;
    tube.radius_m = 0.02;
    tube.rings = 4;
    const TriangleMesh small = TubeMesh(tube).value();
    for (const Vector3d& p : small.positions) {
      mesh_.positions.push_back(p + Vector3d(0.3, 0, 0.3));
    }
    for (const Triangle& t : small.triangles) {
      mesh_.triangles.push_back(t + Triangle::Constant(tube_vertices_));
    }
    binding_ = BindMesh(*rig_, mesh_).value();
  }

  std::vector<int> Select(const VertexSelector& selector) const {
    return SelectVertices(mesh_, selector).value();
  }
  std::vector<std::string> Refused(const VertexSelector& selector) const {
    return ViolationLines(SelectVertices(mesh_, selector).status());
  }

  std::shared_ptr<const VolumeRig> rig_ =
      VolumeRig::Create(TwoLinkArm(Vector3d::UnitZ())).value();
  TriangleMesh mesh_;
  int tube_vertices_ = 0;
  SkinBinding binding_;
};

TEST_F(RebindTest, SelectsByIds) {
  EXPECT_THAT(Select(SelectIds{{7, 3, 7}}), ElementsAre(3, 7));
  EXPECT_THAT(Select(SelectIds{}), IsEmpty());
}

TEST_F(RebindTest, SelectsInsideAndNothingElse) {
  const std::vector<int> sphere = Select(SelectSphere{{0.4, 0, 0.3}, 0.15});
  const std::vector<int> box =
      Select(SelectBox{{0.2, -0.1, 0.2}, {0.6, 0.1, 0.4}});
  EXPECT_EQ(sphere, box);
  EXPECT_EQ(sphere.size(), mesh_.positions.size() - tube_vertices_);
  EXPECT_THAT(Select(SelectSphere{{0, 5, 0}, 1}), IsEmpty());
}

TEST_F(RebindTest, SelectsWhatHangsTogether) {
  EXPECT_EQ(static_cast<int>(Select(SelectComponent{0}).size()),
            tube_vertices_);
  EXPECT_EQ(Select(SelectComponent{tube_vertices_}).front(), tube_vertices_);
}

TEST_F(RebindTest, RaySelectsOnTheSideItComesFrom) {
  // From above, beyond the small tube: the top of the tube only.
  const std::vector<int> top =
      Select(SelectRay{{1.5, 0.001, 2}, {0, 0, -3}, 0.08});
  EXPECT_GT(top.size(), 5);
  for (int v : top) {
    EXPECT_GT(mesh_.positions[v].z(), 0);
    EXPECT_LT(std::abs(mesh_.positions[v].x() - 1.5), 0.081);
  }
  // What is in front is hit, what is behind it is not.
  for (int v : Select(SelectRay{{0.4, 0.001, 2}, {0, 0, -1}, 10})) {
    EXPECT_GE(v, tube_vertices_);
  }
  EXPECT_EQ(Select(SelectRay{{1.5, 0.001, 2}, {0, 0, -1}, 0}).size(), 1);
  EXPECT_THAT(Select(SelectRay{{1.5, 0, 2}, {0, 0, 1}, 1}), IsEmpty());
}

TEST_F(RebindTest, ListsWhatIsWrongWithASelector) {
  EXPECT_THAT(Refused(SelectIds{{-1}}),
              ElementsAre(HasSubstr("ids.vertices[0]: want 0 to")));
  EXPECT_THAT(Refused(SelectSphere{{0, 0, std::nan("")}, -1}),
              ElementsAre("sphere.center: want finite numbers",
                          "sphere.radius_m: want >= 0 m, got -1"));
  EXPECT_THAT(Refused(SelectComponent{1 << 20}),
              ElementsAre(HasSubstr("component_vertex")));
  EXPECT_THAT(
      Refused(SelectRay{{0, 0, 0}, {0, 0, 0}, std::nan("")}),
      ElementsAre("ray.direction: is zero", HasSubstr("ray.geodesic_radius")));
}

TEST_F(RebindTest, MovesTheSelectedAndLeavesTheOldBindingAlone) {
  const SelectComponent small{tube_vertices_};
  const RebindResult result =
      Rebind(*rig_, mesh_, binding_, small, "lower", AssignmentScope::kLink)
          .value();
  EXPECT_EQ(result.selected.size(), mesh_.positions.size() - tube_vertices_);
  EXPECT_EQ(result.moved, result.selected);
  for (int v : result.selected) {
    EXPECT_EQ(result.binding.vertices[v].binding_class, BindingClass::kUser);
    EXPECT_EQ(rig_->link(result.binding.vertices[v].link).id, "lower");
    EXPECT_EQ(rig_->link(binding_.vertices[v].link).id, "upper");
  }
  for (int v = 0; v < tube_vertices_; ++v) {
    EXPECT_EQ(result.binding.vertices[v].volume, binding_.vertices[v].volume);
  }
}

TEST_F(RebindTest, DecisionsSurviveOthersAndCanBeTakenBack) {
  const RebindResult first = Rebind(*rig_, mesh_, binding_, SelectIds{{0, 1}},
                                    "lower", AssignmentScope::kLink)
                                 .value();
  const RebindResult second =
      Rebind(*rig_, mesh_, first.binding, SelectIds{{5}}, "lower",
             AssignmentScope::kLink)
          .value();
  EXPECT_EQ(second.binding.assignments.size(), 3);
  EXPECT_EQ(second.binding.vertices[0].binding_class, BindingClass::kUser);
  EXPECT_THAT(second.moved, ElementsAre(5));
  const RebindResult third =
      Rebind(*rig_, mesh_, second.binding, SelectIds{{0, 5}}, "").value();
  EXPECT_EQ(third.binding.assignments.size(), 1);
  EXPECT_EQ(third.binding.vertices[0].binding_class,
            binding_.vertices[0].binding_class);
  EXPECT_THAT(third.moved, ElementsAre(0, 5));
  // And survive binding anew.
  const SkinBinding again =
      BindMesh(*rig_, mesh_, third.binding.assignments).value();
  EXPECT_EQ(again.vertices[1].binding_class, BindingClass::kUser);
}

TEST_F(RebindTest, UnknownLinkIsNamed) {
  EXPECT_THAT(
      ViolationLines(
          Rebind(*rig_, mesh_, binding_, SelectIds{{0}}, "tail").status()),
      ElementsAre("link_id: no link \"tail\""));
}

TEST_F(RebindTest, HistoryGoesBackAndForth) {
  BindingHistory history(binding_);
  EXPECT_EQ(history.revision(), 1);
  EXPECT_EQ(history.Undo().code(), absl::StatusCode::kFailedPrecondition);
  ASSERT_TRUE(
      history
          .Add(Rebind(*rig_, mesh_, *history.current(), SelectIds{{0}}, "lower")
                   ->binding)
          .ok());
  EXPECT_EQ(history.revision(), 2);
  EXPECT_EQ(history.current()->assignments.size(), 1);
  ASSERT_TRUE(history.Undo().ok());
  EXPECT_EQ(history.current()->assignments.size(), 0);
  ASSERT_TRUE(history.Redo().ok());
  EXPECT_EQ(history.Redo().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ((*history.At(1))->assignments.size(), 0);
  EXPECT_EQ(history.At(3).status().code(), absl::StatusCode::kNotFound);
  // What was undone is gone once something else is decided.
  ASSERT_TRUE(history.Undo().ok());
  ASSERT_TRUE(history.Add(binding_).ok());
  EXPECT_EQ(history.revision_count(), 2);
}

}  // namespace
}  // namespace gelenk
