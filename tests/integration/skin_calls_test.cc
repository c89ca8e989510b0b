// SkinService over the wire: skins are made, edited, undone and deleted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/integration/skin_service_test.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::testing::ElementsAre;
using testing::Fails;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

v1::CreateSkinRequest ShapeRequest(const std::string& shape, int vertices) {
  v1::CreateSkinRequest request;
  request.mutable_skin()->mutable_shape()->set_shape_id(shape);
  request.mutable_skin()->mutable_shape()->set_vertex_count(vertices);
  return request;
}

// The first `count` vertices to `link`.
v1::RebindVerticesRequest RebindRequest(const std::string& skin, int count,
                                        const std::string& link) {
  v1::RebindVerticesRequest request;
  request.set_name(skin);
  request.set_link_id(link);
  request.mutable_selector()->mutable_vertices()->add_starts(0);
  request.mutable_selector()->mutable_vertices()->add_lengths(count);
  return request;
}

class SkinCallsTest : public SkinServiceTest {
 protected:
  static absl::StatusOr<v1::Skin> Get(const std::string& name) {
    v1::GetSkinRequest request;
    request.set_name(name);
    return Call(&Stub::GetSkin, request);
  }
  static absl::StatusOr<v1::Binding> BindingOf(const std::string& name) {
    v1::GetBindingRequest request;
    request.set_name(name);
    request.set_include_vertex_links(true);
    return Call(&Stub::GetBinding, request);
  }
  static absl::Status DeleteSkeleton(const std::string& name) {
    v1::DeleteSkeletonRequest request;
    request.set_name(name);
    return Call(&v1::KinematicsService::Stub::DeleteSkeleton, request).status();
  }
  static absl::Status Delete(const std::string& name) {
    v1::DeleteSkinRequest request;
    request.set_name(name);
    return Call(&Stub::DeleteSkin, request).status();
  }
};

TEST_F(SkinCallsTest, AMeshIsBoundToTheLinksOfItsSkeleton) {
  const v1::CreateSkinRequest request = TubeRequest("tube-one");
  const v1::Skin skin = Create(request);
  EXPECT_EQ(skin.name(), "skins/tube-one");
  EXPECT_EQ(skin.revision(), 1);
  EXPECT_EQ(3 * skin.vertex_count(), request.skin().mesh().positions_size());
  EXPECT_EQ(skin.links_size(), 3);
  EXPECT_EQ(skin.binding_counts().unique_count(), skin.vertex_count());
  EXPECT_THAT(skin.warnings(), IsEmpty());
  EXPECT_FALSE(skin.has_mesh()) << "vertices stay on the server";
  const auto read = Get("skins/tube-one");
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->SerializeAsString(), skin.SerializeAsString());
  EXPECT_THAT(DeleteSkeleton("skeletons/planar-arm"),
              Fails(absl::StatusCode::kFailedPrecondition, "skins/tube-one"));
  EXPECT_EQ(Delete("skins/tube-one"), absl::OkStatus());
  EXPECT_THAT(Get("skins/tube-one").status(),
              Fails(absl::StatusCode::kNotFound, "skins/tube-one"));
}

TEST_F(SkinCallsTest, ABundledShapeBringsItsSkeleton) {
  const v1::Skin skin = Create(ShapeRequest("arm", 2000));
  EXPECT_GT(skin.layered_volumes().muscles_size(), 0);
  v1::GetSkeletonRequest get;
  get.set_name(skin.skeleton());
  const auto skeleton = Call(&v1::KinematicsService::Stub::GetSkeleton, get);
  ASSERT_TRUE(skeleton.ok()) << skeleton.status();
  EXPECT_EQ(skeleton->display_name(), "arm");
  EXPECT_EQ(Delete(skin.name()), absl::OkStatus());
  EXPECT_EQ(DeleteSkeleton(skin.skeleton()), absl::OkStatus());

  EXPECT_THAT(Call(&Stub::CreateSkin, ShapeRequest("nose", 2000)).status(),
              Fails(absl::StatusCode::kInvalidArgument, "humanoid"));
  EXPECT_THAT(Call(&Stub::CreateSkin, ShapeRequest("arm", 1)).status(),
              Fails(absl::StatusCode::kInvalidArgument, "skin.shape"));
  v1::CreateSkinRequest named = ShapeRequest("arm", 2000);
  named.mutable_skin()->set_skeleton("skeletons/planar-arm");
  EXPECT_THAT(Call(&Stub::CreateSkin, named).status(),
              Fails(absl::StatusCode::kInvalidArgument, "skin.skeleton"));
}

TEST_F(SkinCallsTest, ARefusedShapeLeavesNoSkeletonBehind) {
  const auto count = [] {
    v1::ListSkeletonsRequest request;
    request.set_page_size(1000);
    return Call(&v1::KinematicsService::Stub::ListSkeletons, request)
        ->skeletons_size();
  };
  v1::CreateSkinRequest request = ShapeRequest("cylinder", 200);
  request.set_skin_id("taken");
  const v1::Skin skin = Create(request);
  const int before = count();
  EXPECT_EQ(Call(&Stub::CreateSkin, request).status().code(),
            absl::StatusCode::kAlreadyExists);
  EXPECT_EQ(count(), before);
  EXPECT_EQ(Delete(skin.name()), absl::OkStatus());
  EXPECT_EQ(DeleteSkeleton(skin.skeleton()), absl::OkStatus());
}

TEST_F(SkinCallsTest, EveryDeformerIsTaken) {
  v1::CreateSkinRequest request = TubeRequest("");
  const int vertices = request.skin().mesh().positions_size() / 3;
  v1::VertexWeights weights;
  weights.add_joint_ids("j0");
  weights.set_influences_per_vertex(1);
  for (int i = 0; i < vertices; ++i) {
    weights.add_joints(0);
    weights.add_weights(1);
  }
  *request.mutable_skin()->mutable_linear_blend() = weights;
  v1::GetSkeletonRequest get;
  get.set_name("skeletons/planar-arm");
  const std::string joint = Call(&v1::KinematicsService::Stub::GetSkeleton, get)
                                ->joints(0)
                                .joint_id();
  request.mutable_skin()->mutable_linear_blend()->set_joint_ids(0, joint);
  weights.set_joint_ids(0, joint);
  const v1::Skin linear = Create(request);
  EXPECT_TRUE(linear.has_linear_blend());
  *request.mutable_skin()->mutable_dual_quaternion() = weights;
  EXPECT_TRUE(Create(request).has_dual_quaternion());
  request.mutable_skin()->mutable_rigid_attachment()->set_joint_id(joint);
  EXPECT_EQ(Create(request).vertex_count(), vertices);
  request.mutable_skin()->mutable_rigid_attachment()->set_joint_id("nose");
  EXPECT_THAT(Call(&Stub::CreateSkin, request).status(),
              Fails(absl::StatusCode::kInvalidArgument,
                    "skin.rigid_attachment.joint_id: no joint \"nose\""));
  EXPECT_THAT(BindingOf(linear.name()).status(),
              Fails(absl::StatusCode::kFailedPrecondition, linear.name()));
  v1::UpdateMusclesRequest muscles;
  muscles.set_name(linear.name());
  EXPECT_THAT(Call(&Stub::UpdateMuscles, muscles).status(),
              Fails(absl::StatusCode::kFailedPrecondition, "no volumes"));
}

TEST_F(SkinCallsTest, ANurbsSurfaceIsTakenAndATrimmedOneIsNot) {
  v1::CreateSkinRequest request;
  request.mutable_skin()->set_skeleton("skeletons/planar-arm");
  v1::NurbsSurface& surface = *request.mutable_skin()->mutable_nurbs();
  surface.set_u_degree(2);
  surface.set_v_degree(1);
  for (double knot : {0, 0, 0, 1, 1, 1}) surface.add_u_knots(knot);
  for (double knot : {0, 0, 1, 1}) surface.add_v_knots(knot);
  for (double x : {0.0, 0.75, 1.5}) {
    for (double y : {-0.05, 0.05}) {
      for (double number : {x, y, 0.05}) surface.add_points(number);
    }
  }
  const auto skin = Call(&Stub::CreateSkin, request);
  ASSERT_TRUE(skin.ok()) << skin.status();
  EXPECT_GT(skin->vertex_count(), 10);
  EXPECT_LE(skin->estimated_error_m(), 1e-3);
  EXPECT_EQ(skin->links_size(), 3);
  surface.set_trim_curve_count(1);
  EXPECT_THAT(Call(&Stub::CreateSkin, request).status(),
              Fails(absl::StatusCode::kUnimplemented,
                    "skin.nurbs.trim_curve_count: trimmed surfaces"));
  surface.set_trim_curve_count(0);
  surface.set_u_knots(3, -1);
  EXPECT_THAT(Call(&Stub::CreateSkin, request).status(),
              Fails(absl::StatusCode::kInvalidArgument, "skin.nurbs.u_knots"));
}

TEST_F(SkinCallsTest, BadSkinsAreRefusedByField) {
  v1::CreateSkinRequest empty;
  empty.mutable_skin()->set_skeleton("skeletons/planar-arm");
  EXPECT_THAT(Call(&Stub::CreateSkin, empty).status(),
              Fails(absl::StatusCode::kInvalidArgument, "skin.surface"));
  v1::CreateSkinRequest nobody = TubeRequest("");
  nobody.mutable_skin()->set_skeleton("skeletons/nobody");
  EXPECT_THAT(Call(&Stub::CreateSkin, nobody).status(),
              Fails(absl::StatusCode::kNotFound, "skeletons/nobody"));
  v1::CreateSkinRequest broken = TubeRequest("");
  broken.mutable_skin()->mutable_mesh()->set_triangles(7, 1 << 30);
  EXPECT_THAT(
      Call(&Stub::CreateSkin, broken).status(),
      Fails(absl::StatusCode::kInvalidArgument, "skin.mesh.triangles[2]"));
  v1::CreateSkinRequest muscle = TubeRequest("x");
  muscle.mutable_skin()->mutable_layered_volumes()->add_muscles();
  EXPECT_THAT(Call(&Stub::CreateSkin, muscle).status(),
              Fails(absl::StatusCode::kInvalidArgument, "skin_id"));
  muscle.set_skin_id("");
  EXPECT_THAT(Call(&Stub::CreateSkin, muscle).status(),
              Fails(absl::StatusCode::kInvalidArgument,
                    "skin.layered_volumes.muscles[0]"));
  v1::CreateSkinRequest link = TubeRequest("");
  v1::VertexAssignment& assignment =
      *link.mutable_skin()->mutable_layered_volumes()->add_assignments();
  assignment.set_link_id("nose");
  assignment.mutable_vertices()->add_starts(0);
  assignment.mutable_vertices()->add_lengths(1);
  EXPECT_THAT(Call(&Stub::CreateSkin, link).status(),
              Fails(absl::StatusCode::kInvalidArgument,
                    "skin.layered_volumes.assignments[0].link_id"));
  v1::CreateSkinRequest pose = TubeRequest("");
  pose.mutable_skin()->mutable_bind_pose()->add_positions(1);
  EXPECT_THAT(Call(&Stub::CreateSkin, pose).status(),
              Fails(absl::StatusCode::kInvalidArgument, "skin.bind_pose"));
}

TEST_F(SkinCallsTest, ARepeatedRequestAnswersTheFirst) {
  v1::CreateSkinRequest create = TubeRequest("");
  create.set_request_id("create-once");
  const v1::Skin skin = Create(create);
  EXPECT_EQ(Create(create).name(), skin.name());

  v1::RebindVerticesRequest rebind =
      RebindRequest(skin.name(), 20, skin.links(2).link_id());
  rebind.set_request_id("rebind-once");
  const auto first = Call(&Stub::RebindVertices, rebind);
  ASSERT_TRUE(first.ok()) << first.status();
  const auto again = Call(&Stub::RebindVertices, rebind);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->SerializeAsString(), first->SerializeAsString());
  EXPECT_EQ(Get(skin.name())->revision(), 2);
}

TEST_F(SkinCallsTest, VerticesGoWhereAPersonSendsThem) {
  const v1::Skin skin = Create(TubeRequest(""));
  const std::string last = skin.links(2).link_id();
  v1::RebindVerticesRequest request = RebindRequest(skin.name(), 20, last);
  request.set_scope(v1::ASSIGNMENT_SCOPE_LINK);
  request.set_dry_run(true);
  const auto dry = Call(&Stub::RebindVertices, request);
  ASSERT_TRUE(dry.ok()) << dry.status();
  EXPECT_THAT(dry->moved().lengths(), ElementsAre(20));
  EXPECT_EQ(dry->counts_before().user_count(), 0);
  EXPECT_EQ(dry->counts().user_count(), 20);
  EXPECT_GT(dry->stretched_edge_count(), 0);
  EXPECT_EQ(Get(skin.name())->revision(), 1) << "nothing was done";

  request.set_dry_run(false);
  const auto done = Call(&Stub::RebindVertices, request);
  ASSERT_TRUE(done.ok()) << done.status();
  EXPECT_EQ(done->skin().revision(), 2);
  EXPECT_THAT(done->skin().warnings(), ElementsAre(HasSubstr("edges run")));
  const auto binding = BindingOf(skin.name());
  ASSERT_TRUE(binding.ok()) << binding.status();
  EXPECT_EQ(binding->name(), skin.name() + "@2");
  for (int v = 0; v < 20; ++v) EXPECT_EQ(binding->vertex_links(v), 2);
  ASSERT_EQ(binding->assignments_size(), 1);
  EXPECT_EQ(binding->assignments(0).link_id(), last);

  // They come along to another skin on that mesh.
  v1::CreateSkinRequest copy = TubeRequest("");
  *copy.mutable_skin()->mutable_layered_volumes()->mutable_assignments() =
      binding->assignments();
  EXPECT_EQ(Create(copy).binding_counts().user_count(), 20);
}

TEST_F(SkinCallsTest, EverySelectorSelects) {
  const v1::Skin skin = Create(TubeRequest(""));
  v1::RebindVerticesRequest request;
  request.set_name(skin.name());
  request.set_link_id(skin.links(0).link_id());
  request.set_dry_run(true);
  const auto selected = [&request] {
    const auto answer = Call(&Stub::RebindVertices, request);
    EXPECT_EQ(answer.status(), absl::OkStatus());
    int count = 0;
    for (int length : answer->selected().lengths()) count += length;
    return count;
  };
  v1::VertexSelector& selector = *request.mutable_selector();
  selector.mutable_sphere()->set_radius_m(0.09);
  selector.mutable_sphere()->mutable_center();
  EXPECT_EQ(selected(), 16 * 2 + 1) << "two rings and the middle of the end";
  selector.mutable_box()->mutable_lowest()->set_x(1.45);
  selector.mutable_box()->mutable_lowest()->set_y(-1);
  selector.mutable_box()->mutable_lowest()->set_z(-1);
  selector.mutable_box()->mutable_highest()->set_x(2);
  selector.mutable_box()->mutable_highest()->set_y(1);
  selector.mutable_box()->mutable_highest()->set_z(1);
  EXPECT_EQ(selected(), 16 * 3 + 1);
  selector.set_component_vertex(3);
  EXPECT_EQ(selected(), skin.vertex_count());
  selector.mutable_ray()->mutable_origin()->set_x(0.7);
  selector.mutable_ray()->mutable_origin()->set_y(1);
  selector.mutable_ray()->mutable_direction()->set_y(-1);
  EXPECT_EQ(selected(), 1);
  selector.mutable_ray()->set_geodesic_radius_m(0.05);
  EXPECT_GT(selected(), 5);
}

TEST_F(SkinCallsTest, BadEditsAreRefusedByFieldAndChangeNothing) {
  const v1::Skin skin = Create(TubeRequest(""));
  const auto fails = [](const v1::RebindVerticesRequest& request,
                        const std::string& field) {
    EXPECT_THAT(Call(&Stub::RebindVertices, request).status(),
                Fails(absl::StatusCode::kInvalidArgument, field));
  };
  fails(RebindRequest(skin.name(), 1 << 30, ""), "selector.vertices.starts[0]");
  fails(RebindRequest(skin.name(), 3, "nose"), "link_id: no link \"nose\"");
  fails(RebindRequest("skins/tube@zero", 3, ""), "name");
  v1::RebindVerticesRequest none = RebindRequest(skin.name(), 3, "");
  none.clear_selector();
  fails(none, "selector.kind");
  none.mutable_selector()->mutable_sphere()->set_radius_m(-1);
  fails(none, "selector.sphere.radius_m");
  none.mutable_selector()->mutable_box()->mutable_highest()->set_y(-1);
  fails(none, "selector.box.highest: want nothing below");
  none.mutable_selector()->mutable_ray();
  fails(none, "selector.ray.direction");
  none.mutable_selector()->set_component_vertex(-5);
  fails(none, "selector.component_vertex");
  v1::UpdateMusclesRequest muscles;
  muscles.set_name(skin.name());
  muscles.add_removed_muscle_ids("biceps");
  EXPECT_THAT(Call(&Stub::UpdateMuscles, muscles).status(),
              Fails(absl::StatusCode::kInvalidArgument,
                    "removed_muscle_ids[0]: no muscle \"biceps\""));
  EXPECT_EQ(Get(skin.name())->revision(), 1);
}

TEST_F(SkinCallsTest, WhatChangesNothingMakesNoRevision) {
  const v1::Skin skin = Create(TubeRequest(""));
  v1::RebindVerticesRequest nothing =
      RebindRequest(skin.name(), 1, skin.links(2).link_id());
  nothing.mutable_selector()->mutable_sphere()->mutable_center()->set_x(50);
  nothing.mutable_selector()->mutable_sphere()->set_radius_m(0.1);
  const auto answer = Call(&Stub::RebindVertices, nothing);
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_EQ(answer->skin().revision(), 1);
  // Decisions that nobody made are taken back.
  EXPECT_EQ(Call(&Stub::RebindVertices, RebindRequest(skin.name(), 9, ""))
                ->skin()
                .revision(),
            1);
}

TEST_F(SkinCallsTest, AShapeKeepsItsMusclesUnlessOthersAreTold) {
  v1::CreateSkinRequest request = ShapeRequest("arm", 500);
  request.mutable_skin()->mutable_layered_volumes()->set_slenderness(6);
  EXPECT_EQ(Create(request).layered_volumes().muscles_size(), 2);
  request.mutable_skin()
      ->mutable_layered_volumes()
      ->add_fullness()
      ->set_link_id("forearm");
  EXPECT_EQ(Create(request).layered_volumes().muscles_size(), 0);
}

TEST_F(SkinCallsTest, ARigidPieceIsReadAsOne) {
  v1::CreateSkinRequest request = TubeRequest("");
  const std::string joint =
      testing::ArmSkeletonRequest().skeleton().joints(1).joint_id();
  request.mutable_skin()->mutable_rigid_attachment()->set_joint_id(joint);
  EXPECT_EQ(Get(Create(request).name())->rigid_attachment().joint_id(), joint);
}

TEST_F(SkinCallsTest, MusclesAreMergedById) {
  const v1::Skin skin = Create(ShapeRequest("arm", 1000));
  const int before = skin.layered_volumes().muscles_size();
  v1::UpdateMusclesRequest request;
  request.set_name(skin.name());
  v1::Muscle& muscle = *request.add_muscles();
  muscle = skin.layered_volumes().muscles(0);
  muscle.mutable_driven()->set_gain_s(0.33);
  v1::Muscle& volume = *request.add_muscles();
  volume.set_muscle_id("forearm volume");
  volume.set_link_id("forearm");
  volume.mutable_preserve_volume();
  request.add_fullness()->set_link_id("forearm");
  request.mutable_fullness(0)->set_fullness(0.5);
  const auto changed = Call(&Stub::UpdateMuscles, request);
  ASSERT_TRUE(changed.ok()) << changed.status();
  EXPECT_EQ(changed->revision(), 2);
  EXPECT_EQ(changed->layered_volumes().muscles_size(), before + 1);
  EXPECT_EQ(changed->layered_volumes().muscles(0).driven().gain_s(), 0.33);
  EXPECT_EQ(changed->layered_volumes().fullness(0).fullness(), 0.5);
  v1::UpdateMusclesRequest remove;
  remove.set_name(skin.name());
  remove.add_removed_muscle_ids("forearm volume");
  EXPECT_EQ(
      Call(&Stub::UpdateMuscles, remove)->layered_volumes().muscles_size(),
      before);
}

TEST_F(SkinCallsTest, AnOlderRevisionComesBack) {
  const v1::Skin skin = Create(TubeRequest(""));
  ASSERT_TRUE(Call(&Stub::RebindVertices,
                   RebindRequest(skin.name(), 20, skin.links(2).link_id()))
                  .ok());
  v1::RollbackSkinRequest undo;
  undo.set_name(skin.name());
  EXPECT_THAT(Call(&Stub::RollbackSkin, undo).status(),
              Fails(absl::StatusCode::kInvalidArgument, "@{revision}"));
  undo.set_name(skin.name() + "@1");
  const auto undone = Call(&Stub::RollbackSkin, undo);
  ASSERT_TRUE(undone.ok()) << undone.status();
  EXPECT_EQ(undone->revision(), 3);
  EXPECT_EQ(undone->binding_counts().user_count(), 0);
  EXPECT_EQ(undone->base_revision(), 0) << "nothing more to undo";
  EXPECT_EQ(Get(skin.name() + "@2")->base_revision(), 1);
  // And the undo of undo.
  undo.set_name(skin.name() + "@2");
  EXPECT_EQ(Call(&Stub::RollbackSkin, undo)->binding_counts().user_count(), 20);
  EXPECT_EQ(Get(skin.name() + "@1")->binding_counts().user_count(), 0);
  undo.set_name(skin.name() + "@77");
  EXPECT_THAT(Call(&Stub::RollbackSkin, undo).status(),
              Fails(absl::StatusCode::kNotFound, "@77"));
}

TEST_F(SkinCallsTest, SkinsAreListedInPages) {
  for (const char* id : {"list-a", "list-b", "list-c"}) Create(TubeRequest(id));
  v1::ListSkinsRequest request;
  request.set_page_size(1);
  std::vector<std::string> names;
  do {
    const auto page = Call(&Stub::ListSkins, request);
    ASSERT_TRUE(page.ok()) << page.status();
    for (const v1::Skin& skin : page->skins()) names.push_back(skin.name());
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  EXPECT_THAT(names, ::testing::IsSupersetOf(
                         {"skins/list-a", "skins/list-b", "skins/list-c"}));
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
}

}  // namespace
}  // namespace gelenk
