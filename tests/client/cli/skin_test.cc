#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/cli/picture/mesh_picture.h"
#include "client/cli/service.h"
#include "client/cli/skin/binding_text.h"
#include "client/cli/skin/deformed_frames.h"
#include "client/cli/skin/selector_argument.h"
#include "client/cli/skin/skin_sending.h"
#include "client/cli/skin/skin_source.h"
#include "convert/skin_surface.h"
#include "gelenk/skin/mesh_around.h"
#include "tests/client/cli/well_formed_xml.h"
#include "tests/testing/status_matchers.h"

namespace gelenk::cli {
namespace {

using ::gelenk::testing::Fails;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(VertexRunsTest, AreReadInAnyOrder) {
  const v1::VertexRuns runs = ParseVertexRuns("7,0-3,2-5,9-9").value();
  EXPECT_THAT(runs.starts(), ElementsAre(0, 4, 7, 9));
  EXPECT_THAT(runs.lengths(), ElementsAre(4, 2, 1, 1));
  EXPECT_EQ(RunsText(runs), "8 vertices: 0-3, 4-5, 7, 9");
}

TEST(VertexRunsTest, NameThePieceThatIsNone) {
  for (const char* text :
       {"", "x", "1,,2", "-1", "3-2", "1-", "1-2-3", "1.5", "99999999999"}) {
    EXPECT_THAT(ParseVertexRuns(text).status(),
                Fails(absl::StatusCode::kInvalidArgument, "0-99,120"))
        << text;
  }
}

TEST(VertexRunsTest, LongListsAreCut) {
  v1::VertexRuns runs;
  for (int i = 0; i < 40; ++i) {
    runs.add_starts(2 * i);
    runs.add_lengths(1);
  }
  EXPECT_EQ(RunsText(runs),
            "40 vertices: 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, ...");
  EXPECT_EQ(RunsText({}), "0 vertices");
}

TEST(SelectorTest, TakesNumbersByCount) {
  SelectorArguments arguments;
  arguments.ray = "1,2,3,0,-1,0,0.5";
  const v1::VertexSelector selector = SelectorOf(arguments).value();
  EXPECT_EQ(selector.ray().origin().z(), 3);
  EXPECT_EQ(selector.ray().direction().y(), -1);
  EXPECT_EQ(selector.ray().geodesic_radius_m(), 0.5);
  arguments.ray = "1,2,3";
  EXPECT_THAT(SelectorOf(arguments).status(),
              Fails(absl::StatusCode::kInvalidArgument, "--ray"));
}

// A triangle towards the viewer, and one that faces away.
MeshPanel Panel() {
  return {"a < b", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

TEST(MeshPictureTest, ShowsWhatFacesTheViewer) {
  const std::string svg = MeshPictureSvg("two panels", {{0, 1, 2}, {0, 2, 1}},
                                         {Panel(), Panel()}, {});
  const auto counts = CountElements(svg);
  ASSERT_TRUE(counts.ok()) << counts.status();
  EXPECT_EQ(counts->at("polygon"), 2) << "one in each";
  EXPECT_EQ(counts->at("rect.panel"), 2);
  EXPECT_THAT(svg, HasSubstr("a &lt; b"));
}

TEST(MeshPictureTest, ThingsInFrontCoverThoseBehind) {
  // The same triangle twice; the one in front is lit from the side.
  MeshPanel panel;
  panel.positions = {{0, 0, 1}, {1, 0, 1}, {0, 1, 2},
                     {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::string in_order =
      MeshPictureSvg("", {{3, 4, 5}, {0, 1, 2}}, {panel}, {});
  const std::string turned =
      MeshPictureSvg("", {{0, 1, 2}, {3, 4, 5}}, {panel}, {});
  EXPECT_EQ(turned, in_order) << "depth decides";
}

TEST(MeshPictureTest, AnEmptyMeshIsAPictureStill) {
  EXPECT_TRUE(CountElements(MeshPictureSvg("", {}, {}, {})).ok());
  EXPECT_TRUE(
      CountElements(MeshPictureSvg("", {}, {MeshPanel{"nothing", {}}}, {}))
          .ok());
}

// In one message and in pieces that cut vertices apart.
TEST(SkinSendingTest, ASkinComesAsItIsHoweverItIsSent) {
  const auto service = *Service::Open("");
  client::Connection& connection = *service->connection();
  SkinSource source = *ReadSkinSource({.path = "arm", .vertex_count = 300});
  v1::CreateSkinRequest request;
  *request.mutable_skin() = source.skin;
  const v1::Skin shape = *SendSkin(connection, request);
  const auto tube = TubeMesh({1, 0.05, 20, 12}).value();
  request.mutable_skin()->set_skeleton(shape.skeleton());
  convert::ToProto(tube, request.mutable_skin()->mutable_mesh());
  v1::VertexAssignment& assignment =
      *request.mutable_skin()->mutable_layered_volumes()->add_assignments();
  assignment.set_link_id("hand");
  assignment.set_scope(v1::ASSIGNMENT_SCOPE_LINK);
  assignment.mutable_vertices()->add_starts(3);
  assignment.mutable_vertices()->add_lengths(7);
  const auto vertices_of = [&](const v1::Skin& skin) {
    v1::GetSkeletonRequest get;
    get.set_name(skin.skeleton());
    const v1::Skeleton skeleton =
        *connection.Call(&v1::KinematicsService::Stub::GetSkeleton, get);
    std::vector<v1::SkinPose> poses(1);
    *poses[0].mutable_pose() = skeleton.rest_pose();
    poses[0].mutable_pose()->set_positions(7, 1.2);
    return DeformSkin(connection, skin.name(), poses,
                      v1::VERTEX_ENCODING_FLOAT32, {0})
        ->positions.at(0);
  };
  for (const bool is_weighted : {false, true}) {
    if (is_weighted) {
      v1::VertexWeights& weights =
          *request.mutable_skin()->mutable_linear_blend();
      weights.add_joint_ids("upper_arm");
      weights.add_joint_ids("forearm");
      weights.set_influences_per_vertex(2);
      for (size_t v = 0; v < tube.positions.size(); ++v) {
        weights.add_joints(0);
        weights.add_joints(1);
        weights.add_weights(0.5f);
        weights.add_weights(0.01f * static_cast<float>(v % 100));
      }
    }
    const auto whole = SendSkin(connection, request);
    ASSERT_TRUE(whole.ok()) << whole.status();
    for (size_t piece_bytes : {16, 1000, 4000}) {
      const auto pieces = SendSkin(connection, request, piece_bytes);
      ASSERT_TRUE(pieces.ok()) << pieces.status();
      EXPECT_EQ(pieces->binding_counts().user_count(), is_weighted ? 0 : 7);
      EXPECT_EQ(vertices_of(*pieces), vertices_of(*whole)) << piece_bytes;
    }
  }
  // What is wrong is told as the server says it.
  request.mutable_skin()->mutable_mesh()->set_triangles(0, 1 << 20);
  EXPECT_EQ(SendSkin(connection, request, 16).status().code(),
            absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace gelenk::cli
