// Surfaces, deformers, muscles and bindings between the contract and the core.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "convert/muscle.h"
#include "convert/skin_binding.h"
#include "convert/skin_deformer.h"
#include "convert/skin_surface.h"
#include "convert/vertex_runs.h"
#include "gelenk/skin/example_shapes.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ViolationLines;

v1::TriangleMesh Corner() {
  v1::TriangleMesh proto;
  for (float number : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) {
    proto.add_positions(number);
  }
  for (int vertex : {0, 1, 2}) proto.add_triangles(vertex);
  return proto;
}

TEST(TriangleMeshTest, ComesRound) {
  const TriangleMesh mesh = convert::FromProto(Corner()).value();
  EXPECT_EQ(mesh.positions[2], Eigen::Vector3d::UnitY());
  EXPECT_EQ(mesh.triangles[0], Triangle(0, 1, 2));
  v1::TriangleMesh again;
  convert::ToProto(mesh, &again);
  EXPECT_EQ(again.SerializeAsString(), Corner().SerializeAsString());
}

TEST(TriangleMeshTest, RefusesWhatDoesNotFit) {
  v1::TriangleMesh uneven = Corner();
  uneven.add_positions(1);
  uneven.add_triangles(1);
  uneven.add_normals(1);
  EXPECT_THAT(ViolationLines(convert::FromProto(uneven).status()),
              ElementsAre("positions: want three numbers each, got 10",
                          "triangles: want three numbers each, got 4",
                          "normals: want three numbers each, got 1"));
  v1::TriangleMesh bad = Corner();
  bad.set_positions(4, std::numeric_limits<float>::quiet_NaN());
  bad.set_triangles(1, 3);
  EXPECT_THAT(ViolationLines(convert::FromProto(bad).status()),
              ElementsAre(HasSubstr("positions[1]: "),
                          HasSubstr("triangles[0]: want indices below 3")));
  EXPECT_THAT(ViolationLines(convert::FromProto(Corner(), {2, 9}).status()),
              ElementsAre("positions: want 1 to 2 vertices, got 3"));
  EXPECT_THAT(ViolationLines(convert::FromProto(v1::TriangleMesh()).status()),
              ElementsAre(HasSubstr("positions: want 1 to")));
}

TEST(NurbsSurfaceTest, WeightsAreOneWhereNobodySaysOtherwise) {
  v1::NurbsSurface proto;
  proto.set_u_degree(1);
  proto.set_v_degree(1);
  for (double knot : {0, 0, 1, 1}) {
    proto.add_u_knots(knot);
    proto.add_v_knots(knot);
  }
  for (int i = 0; i < 12; ++i) proto.add_points(i);
  const NurbsSurface surface = convert::FromProto(proto).value();
  EXPECT_EQ(CheckNurbs(surface), absl::OkStatus());
  EXPECT_EQ(surface.points[3], Eigen::Vector3d(9, 10, 11));
  EXPECT_THAT(surface.weights, ElementsAre(1, 1, 1, 1));
  proto.add_points(1);
  EXPECT_THAT(ViolationLines(convert::FromProto(proto).status()),
              ElementsAre("points: want three numbers each, got 13"));
}

TEST(MuscleTest, EveryModeComesRound) {
  SkinMuscles muscles;
  Muscle driven;
  driven.id = "biceps";
  driven.link_id = "upper";
  driven.driver_joint_id = "lower";
  driven.gain_s = 0.5;
  driven.gain_t = 0.25;
  driven.pivot_m = {-0.1, 0.2};
  Muscle scaled = driven;
  scaled.id = "triceps";
  scaled.mode = MuscleMode::kExplicit;
  scaled.scale_s = {1.1, 1.2};
  scaled.scale_t = {1.3, 1.4};
  Muscle preserving;
  preserving.id = "volume";
  preserving.link_id = "lower";
  preserving.mode = MuscleMode::kPreserveVolume;
  preserving.min_scale = 0.9;
  preserving.max_scale = 1.1;
  muscles.muscles = {driven, scaled, preserving};
  muscles.fullness = {{"lower", 0.5}};

  v1::LayeredVolumes proto;
  convert::ToProto(muscles, proto.mutable_muscles(), proto.mutable_fullness());
  const SkinMuscles read =
      convert::FromProto(proto.muscles(), proto.fullness()).value();
  ASSERT_EQ(read.muscles.size(), 3u);
  EXPECT_EQ(read.muscles[0].driver_joint_id, "lower");
  EXPECT_EQ(read.muscles[0].gain_t, 0.25);
  EXPECT_EQ(read.muscles[0].pivot_m, driven.pivot_m);
  EXPECT_EQ(read.muscles[1].mode, MuscleMode::kExplicit);
  EXPECT_EQ(read.muscles[1].scale_s, scaled.scale_s);
  EXPECT_EQ(read.muscles[1].scale_t, scaled.scale_t);
  EXPECT_EQ(read.muscles[1].pivot_m, scaled.pivot_m);
  EXPECT_EQ(read.muscles[2].mode, MuscleMode::kPreserveVolume);
  EXPECT_EQ(read.muscles[2].min_scale, 0.9);
  EXPECT_EQ(read.muscles[2].max_scale, 1.1);
  EXPECT_EQ(read.fullness[0].fullness, 0.5);
}

TEST(MuscleTest, WantsAMode) {
  v1::LayeredVolumes proto;
  proto.add_muscles()->set_muscle_id("biceps");
  EXPECT_THAT(
      ViolationLines(
          convert::FromProto(proto.muscles(), proto.fullness()).status()),
      ElementsAre(HasSubstr("muscles[0]: want one of driven")));
}

TEST(VertexRunsTest, ComeRound) {
  const std::vector<int> vertices = {0, 1, 2, 5, 7, 8};
  v1::VertexRuns proto;
  convert::ToProto(vertices, &proto);
  EXPECT_THAT(proto.starts(), ElementsAre(0, 5, 7));
  EXPECT_THAT(proto.lengths(), ElementsAre(3, 1, 2));
  EXPECT_EQ(convert::FromProto(proto, 9).value(), vertices);
  EXPECT_THAT(convert::FromProto(v1::VertexRuns(), 9).value(), IsEmpty());
}

TEST(VertexRunsTest, RiseWithinTheMesh) {
  const auto lines = [](int start, int length) {
    v1::VertexRuns proto;
    proto.add_starts(2);
    proto.add_lengths(3);
    proto.add_starts(start);
    proto.add_lengths(length);
    return ViolationLines(convert::FromProto(proto, 9).status());
  };
  EXPECT_THAT(lines(5, 4), IsEmpty());
  for (const auto& [start, length] :
       std::vector<std::pair<int, int>>{{4, 1},
                                        {2, 3},
                                        {5, 5},
                                        {5, 0},
                                        {5, -1},
                                        {-1, 2},
                                        {9, 1},
                                        {5, std::numeric_limits<int>::max()}}) {
    EXPECT_THAT(lines(start, length),
                ElementsAre(HasSubstr("starts[1]: want runs that rise")))
        << start << " " << length;
  }
  v1::VertexRuns uneven;
  uneven.add_starts(1);
  EXPECT_THAT(ViolationLines(convert::FromProto(uneven, 9).status()),
              ElementsAre("lengths: want 1 as starts, got 0"));
}

TEST(VertexWeightsTest, FollowJointsByName) {
  const auto skeleton = MakeSkinShape("cylinder", 100)->skeleton;
  v1::VertexWeights proto;
  proto.add_joint_ids("lower");
  proto.add_joint_ids("upper");
  proto.set_influences_per_vertex(1);
  for (int at : {0, 1}) {
    proto.add_joints(at);
    proto.add_weights(1);
  }
  for (int i = 0; i < 24; ++i) proto.add_joint_from_mesh(i);
  const auto weights = convert::FromProto(*skeleton, proto).value();
  const int lower = skeleton->FindJoint("lower");
  EXPECT_THAT(weights.weights.joints,
              ElementsAre(lower, skeleton->FindJoint("upper")));
  EXPECT_EQ(weights.joint_from_mesh[lower](1, 2), 6) << "row by row";
  proto.add_joints(2);
  proto.add_joint_ids("nose");
  proto.add_joint_ids("upper");
  EXPECT_THAT(ViolationLines(convert::FromProto(*skeleton, proto).status()),
              ElementsAre("joint_ids[2]: no joint \"nose\"",
                          "joint_ids[3]: is there twice: \"upper\"",
                          HasSubstr("joint_from_mesh: want none or 12")));
  proto.set_joints(0, 4);
  proto.set_joints(1, -1);
  EXPECT_THAT(ViolationLines(convert::FromProto(*skeleton, proto).status()),
              ::testing::IsSupersetOf({HasSubstr("joints[0]: want 0 to"),
                                       HasSubstr("joints[1]: want 0 to")}));
}

TEST(AssignmentsTest, ComeRoundInGroups) {
  const std::vector<VertexAssignment> assignments = {
      {1, "upper", AssignmentScope::kChain},
      {2, "upper", AssignmentScope::kChain},
      {4, "lower", AssignmentScope::kLink}};
  convert::AssignmentList proto;
  convert::ToProto(assignments, &proto);
  ASSERT_EQ(proto.size(), 2);
  const auto read = convert::FromProto(proto, 5).value();
  ASSERT_EQ(read.size(), 3u);
  EXPECT_EQ(read[0].vertex, 4);
  EXPECT_EQ(read[0].scope, AssignmentScope::kLink);
  EXPECT_EQ(read[2].vertex, 2);
  EXPECT_EQ(read[2].link_id, "upper");
}

TEST(AssignmentsTest, ASmallMessageCannotBecomeALargeAnswer) {
  convert::AssignmentList proto;
  for (int i = 0; i < 3; ++i) {
    v1::VertexAssignment* assignment = proto.Add();
    assignment->set_link_id("upper");
    assignment->mutable_vertices()->add_starts(0);
    assignment->mutable_vertices()->add_lengths(4);
  }
  EXPECT_THAT(
      ViolationLines(convert::FromProto(proto, 8).status()),
      ElementsAre("assignments[2].vertices: want at most 8 vertices in all "
                  "assignments"));
  proto[0].set_link_id(std::string(64, 'x'));
  EXPECT_THAT(ViolationLines(convert::FromProto(proto, 8).status()),
              ElementsAre(HasSubstr("assignments[0].link_id")));
  proto[0].set_link_id("upper");
  proto[0].set_scope(static_cast<v1::AssignmentScope>(9));
  EXPECT_THAT(ViolationLines(convert::FromProto(proto, 8).status()),
              ElementsAre("assignments[0].scope: no such scope: 9"));
}

TEST(VertexSelectorTest, EveryKindIsRead) {
  v1::VertexSelector proto;
  EXPECT_THAT(ViolationLines(convert::FromProto(proto, 9).status()),
              ElementsAre(HasSubstr("kind: want one of vertices")));
  proto.mutable_vertices()->add_starts(3);
  proto.mutable_vertices()->add_lengths(2);
  EXPECT_THAT(
      std::get<SelectIds>(convert::FromProto(proto, 9).value()).vertices,
      ElementsAre(3, 4));
  proto.mutable_sphere()->mutable_center()->set_y(2);
  proto.mutable_sphere()->set_radius_m(0.5);
  const auto sphere =
      std::get<SelectSphere>(convert::FromProto(proto, 9).value());
  EXPECT_EQ(sphere.center, Eigen::Vector3d(0, 2, 0));
  EXPECT_EQ(sphere.radius_m, 0.5);
  proto.mutable_box()->mutable_lowest()->set_x(-1);
  proto.mutable_box()->mutable_highest()->set_z(3);
  const auto box = std::get<SelectBox>(convert::FromProto(proto, 9).value());
  EXPECT_EQ(box.lowest, Eigen::Vector3d(-1, 0, 0));
  EXPECT_EQ(box.highest, Eigen::Vector3d(0, 0, 3));
  proto.set_component_vertex(7);
  EXPECT_EQ(
      std::get<SelectComponent>(convert::FromProto(proto, 9).value()).vertex,
      7);
  proto.mutable_ray()->mutable_origin()->set_x(1);
  proto.mutable_ray()->mutable_direction()->set_y(1);
  proto.mutable_ray()->set_geodesic_radius_m(0.1);
  const auto ray = std::get<SelectRay>(convert::FromProto(proto, 9).value());
  EXPECT_EQ(ray.origin, Eigen::Vector3d::UnitX());
  EXPECT_EQ(ray.direction, Eigen::Vector3d::UnitY());
  EXPECT_EQ(ray.geodesic_radius_m, 0.1);
}

TEST(BindingTest, TellsWhatIsAskedFor) {
  const SkinShape shape = MakeSkinShape("humanoid", 2000).value();
  const auto rig =
      VolumeRig::Create(shape.skeleton, shape.links, shape.muscles).value();
  const auto skin = LayeredSkin::Bind(*rig, shape.mesh).value();
  v1::Binding brief;
  convert::ToProto(*skin, {}, &brief);
  EXPECT_EQ(brief.links_size(), rig->link_count());
  EXPECT_EQ(brief.classes_size(), 0);
  EXPECT_EQ(brief.ambiguous_size(), 0);
  const v1::BindingCounts& counts = brief.counts();
  EXPECT_EQ(counts.unique_count() + counts.ambiguous_count() +
                counts.outside_count() + counts.blend_count() +
                counts.user_count(),
            skin->vertex_count());
  int of_links = 0;
  for (const v1::Binding::Link& link : brief.links()) {
    of_links += link.counts().unique_count();
  }
  EXPECT_EQ(of_links, counts.unique_count());

  v1::Binding whole;
  convert::ToProto(*skin, {true, true, true}, &whole);
  EXPECT_EQ(whole.ambiguous_size(), counts.ambiguous_count());
  EXPECT_EQ(whole.outside_size(), counts.outside_count());
  ASSERT_EQ(whole.vertex_links_size(), skin->vertex_count());
  int listed = 0;
  for (const v1::Binding::Class& vertices : whole.classes()) {
    for (int length : vertices.vertices().lengths()) listed += length;
  }
  EXPECT_EQ(listed, skin->vertex_count());
  for (const v1::Binding::Ambiguous& vertex : whole.ambiguous()) {
    EXPECT_GE(vertex.links_size(), 2);
    EXPECT_EQ(vertex.scores_size(), vertex.links_size());
    EXPECT_EQ(whole.vertex_links(vertex.vertex()), vertex.bound_link());
  }
}

TEST(SkinLinkTest, OverridesAreRead) {
  v1::LayeredVolumes proto;
  EXPECT_EQ(convert::FromProto(proto).slenderness,
            SkinLinkOptions().slenderness);
  proto.set_slenderness(0.3);
  v1::SkinLinkOverride* link = proto.add_overrides();
  link->set_joint_id("upper");
  link->set_length_m(0.7);
  link->mutable_direction()->set_y(1);
  link->set_half_extent_s_m(0.1);
  link->set_half_extent_t_m(0.2);
  link->set_continuation_joint_id("");
  proto.add_overrides()->set_omit(true);
  const SkinLinkOptions options = convert::FromProto(proto);
  EXPECT_EQ(options.slenderness, 0.3);
  const SkinLinkOverride& read = options.overrides[0];
  EXPECT_EQ(read.joint_id, "upper");
  EXPECT_EQ(read.length_m, 0.7);
  EXPECT_EQ(read.direction, Eigen::Vector3d::UnitY());
  EXPECT_EQ(read.s_direction, std::nullopt);
  EXPECT_EQ(read.half_extents_m, Eigen::Vector2d(0.1, 0.2));
  EXPECT_EQ(read.continuation_joint_id, "");
  EXPECT_FALSE(read.omit);
  EXPECT_TRUE(options.overrides[1].omit);
  EXPECT_EQ(options.overrides[1].half_extents_m, std::nullopt);
}

}  // namespace
}  // namespace gelenk
