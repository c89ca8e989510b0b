#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/cli/picture/mesh_picture.h"
#include "client/cli/skin/binding_text.h"
#include "client/cli/skin/selector_argument.h"
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

}  // namespace
}  // namespace gelenk::cli
