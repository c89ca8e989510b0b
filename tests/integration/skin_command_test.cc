// `gelenk skin`, with a service of its own and against a real gelenkd.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gelenk/import/gltf_reader.h"
#include "tests/integration/command_test.h"

namespace gelenk {
namespace {

using ::testing::HasSubstr;

// A box around the walk's left thigh would do; a triangle is enough.
constexpr char kObj[] =
    "v 0 0.9 0\nv 0.1 0.9 0\nv 0 1 0.05\nf 1 2 3\nf 1 3 2\n";

class SkinCommandTest : public ServedCommandTest {};

INSTANTIATE_TEST_SUITE_P(Hosts, SkinCommandTest,
                         ::testing::Values(Host::kInProcess, Host::kServer),
                         HostName);

TEST_P(SkinCommandTest, BindReportsLinkByLink) {
  const Ending ending = Run({"skin", "bind", "arm", "--vertices", "800"});
  EXPECT_EQ(ending.exit_code, 0) << ending.err;
  for (const char* word : {"LINK", "AMBIGUOUS", "upper_arm", "forearm", "hand",
                           "all", "vertices"}) {
    EXPECT_THAT(ending.out, HasSubstr(word));
  }
  const json answer =
      RunJson({"skin", "report", "humanoid", "--vertices", "1500"});
  EXPECT_GT(answer["binding"]["counts"]["blendCount"], 0);
  EXPECT_EQ(answer["skin"]["vertexCount"].get<int>() > 500, true);
  EXPECT_FALSE(answer["binding"]["classes"].empty());
}

TEST_P(SkinCommandTest, DecisionsAreKeptInAFile) {
  const Ending dry = Run({"skin", "rebind", "arm", "--vertices", "800", "--ids",
                          "0-9", "--link", "hand", "--scope", "link",
                          "--dry-run", "--assignments", "hand.json"});
  EXPECT_EQ(dry.exit_code, 0) << dry.err;
  EXPECT_THAT(dry.out, HasSubstr("would move 10 vertices: 0-9"));
  EXPECT_FALSE(fs::exists(folder_ / "hand.json"));
  const Ending done =
      Run({"skin", "rebind", "arm", "--vertices", "800", "--ids", "0-9",
           "--link", "hand", "--scope", "link", "--assignments", "hand.json"});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("moved 10 vertices"));
  const json answer = RunJson({"skin", "bind", "arm", "--vertices", "800",
                               "--assignments", "hand.json"});
  EXPECT_EQ(answer["binding"]["counts"]["userCount"], 10);
  // A shape keeps its muscles beside them.
  EXPECT_EQ(answer["skin"]["layeredVolumes"]["muscles"].size(), 2u);
  // Only rebind begins such a file.
  EXPECT_THAT(Run({"skin", "bind", "arm", "--assignments", "none.json"}).err,
              HasSubstr("none.json"));
}

TEST_P(SkinCommandTest, DeformTellsWhichLinksFoldAndWritesTheLastFrame) {
  const Ending ending =
      Run({"skin", "deform", "arm", "--vertices", "800", "--pose",
           "0,0,0,0,0,0,1,2.9,0,0,0,1", "--out", "bent.obj"});
  EXPECT_EQ(ending.exit_code, 0) << ending.err;
  EXPECT_THAT(ending.out, HasSubstr("LINK"));
  EXPECT_THAT(ending.out, HasSubstr("forearm"));
  const std::string obj = Read(folder_ / "bent.obj");
  EXPECT_THAT(obj, HasSubstr("v "));
  EXPECT_THAT(obj, HasSubstr("f "));
  // Control planes are deformed by on this side.
  EXPECT_EQ(Run({"skin", "deform", "arm", "--vertices", "800", "--pose",
                 "0,0,0,0,0,0,1,2.9,0,0,0,1", "--encoding", "planes", "--out",
                 "planes.obj"})
                .exit_code,
            0);
  EXPECT_EQ(Read(folder_ / "planes.obj").size() > obj.size() / 2, true);
}

TEST_P(SkinCommandTest, DeformTellsWhatFramesTakeAndDrawsThem) {
  Write("skin.obj", kObj);
  const Ending ending = Run({"skin", "deform", "skin.obj", "--skeleton",
                             "walk.bvh", "--bvh", "walk.bvh", "--frames", "20",
                             "--encoding", "delta", "--picture", "walk.svg"});
  EXPECT_EQ(ending.exit_code, 0) << ending.err;
  EXPECT_THAT(ending.out, HasSubstr("20, 1 keyframes"));
  EXPECT_THAT(Read(folder_ / "walk.svg"), HasSubstr("frame 19"));
}

TEST_P(SkinCommandTest, AMotionOfAnotherBodyIsBroughtOntoTheSkin) {
  const Ending other = Run({"skin", "deform", "humanoid", "--vertices", "500",
                            "--motion", "walk.bvh"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("another skeleton wants --retarget"));
  const Ending ending =
      Run({"skin", "deform", "humanoid", "--vertices", "500", "--motion",
           "walk.bvh", "--retarget", "--frames", "10", "--encoding", "delta"});
  EXPECT_EQ(ending.exit_code, 0) << ending.err;
  EXPECT_THAT(ending.out, HasSubstr("10, 1 keyframes"));
  EXPECT_EQ(Run({"skin", "export", "humanoid", "--vertices", "500", "--motion",
                 "walk.bvh", "--retarget", "--out", "walking.glb"})
                .exit_code,
            0);
}

TEST_P(SkinCommandTest, ExportIsReadByOthers) {
  const Ending ending = Run({"skin", "export", "humanoid", "--vertices", "1500",
                             "--out", "body.glb"});
  EXPECT_EQ(ending.exit_code, 0) << ending.err;
  EXPECT_THAT(ending.out, HasSubstr("vertices near branches are not exact"));
  EXPECT_EQ(ReadGltf(Read(folder_ / "body.glb")).status(), absl::OkStatus());
}

TEST_P(SkinCommandTest, TheDemoBendsAnArm) {
  const Ending ending = Run({"skin", "demo", "--vertices", "500", "--picture",
                             "arm.svg", "--out", "arm.glb"});
  EXPECT_EQ(ending.exit_code, 0) << ending.err;
  EXPECT_THAT(ending.out, HasSubstr("biceps on"));
  const std::string picture = Read(folder_ / "arm.svg");
  EXPECT_THAT(picture, HasSubstr("150°, biceps on"));
  EXPECT_THAT(picture, HasSubstr("150°, off"));
  EXPECT_EQ(ReadGltf(Read(folder_ / "arm.glb")).status(), absl::OkStatus());
}

TEST_P(SkinCommandTest, MistakesAreNamed) {
  const auto fails = [this](const std::vector<std::string>& arguments,
                            int exit_code, const std::string& words) {
    const Ending ending = Run(arguments);
    EXPECT_EQ(ending.exit_code, exit_code);
    EXPECT_THAT(ending.err, HasSubstr(words));
  };
  Write("skin.obj", kObj);
  Write("bad.obj", "v 0 0 zero\n");
  fails({"skin", "bind", "nose"}, 1, "want skins/NAME, cylinder");
  fails({"skin", "bind", "skin.obj"}, 1, "--skeleton");
  fails({"skin", "bind", "bad.obj", "--skeleton", "walk.bvh"}, 1, "line 1");
  fails({"skin", "bind", "arm", "--method", "linear"}, 1, "--method: is of");
  fails({"skin", "bind", "arm", "--skeleton", "walk.bvh"}, 1,
        "--skeleton: is of an .obj or .json file, not of \"arm\"");
  fails({"skin", "bind", "arm", "--unit", "0.01"}, 1, "--unit: is of");
  fails({"skin", "bind", "skin.obj", "--skeleton", "walk.bvh", "--mesh", "m"},
        1, "--mesh: is of");
  fails({"skin", "bind", "skin.obj", "--vertices", "9"}, 1, "--vertices: is");
  fails({"skin", "rebind", "skins/a", "--undo", "--dry-run"}, 2, "--undo");
  fails({"skin", "rebind", "skins/a", "--undo", "--ids", "1"}, 2, "--undo");
  fails({"skin", "export", "arm", "--out", "arm.obj"}, 2, ".glb");
  fails({"skin", "demo", "--picture", "arm.png"}, 2, ".svg");
  fails({"skin", "delete", "arm"}, 1,
        GetParam() == Host::kServer ? "want skins/NAME" : "--server");
  fails({"skin", "rebind", "arm", "--link", "hand"}, 1, "selector.kind");
  fails({"skin", "rebind", "arm", "--ids", "5-1"}, 2, "0-99,120");
  fails({"skin", "rebind", "arm", "--sphere", "1,2"}, 1, "--sphere");
  fails({"skin", "rebind", "arm", "--undo"}, 1, "skins/NAME");
  fails({"skin", "rebind", "arm", "--ids", "0", "--link", "nose"}, 1,
        "no link \"nose\"");
  fails({"skin", "deform", "arm", "--pose", "1"}, 1, "poses[0].pose");
  fails({"skin", "bind", "skins/nobody"}, 1, "skins/nobody");
  fails({"skin"}, 2, "subcommand");
}

TEST_P(SkinCommandTest, OnAServerASkinStaysAndEditsAreUndone) {
  if (GetParam() == Host::kInProcess) return;
  EXPECT_EQ(
      Run({"skin", "bind", "arm", "--vertices", "800", "--keep", "my-arm"})
          .exit_code,
      0);
  EXPECT_EQ(Run({"skin", "rebind", "skins/my-arm", "--ids", "0-9", "--link",
                 "hand", "--scope", "link"})
                .exit_code,
            0);
  EXPECT_EQ(RunJson({"skin", "bind",
                     "skins/my-arm"})["binding"]["counts"]["userCount"],
            10);
  const Ending undone = Run({"skin", "rebind", "skins/my-arm", "--undo"});
  EXPECT_EQ(undone.exit_code, 0) << undone.err;
  EXPECT_EQ(RunJson({"skin", "bind",
                     "skins/my-arm"})["binding"]["counts"]["userCount"],
            0);
  EXPECT_THAT(Run({"skin", "rebind", "skins/my-arm", "--undo"}).err,
              HasSubstr("nothing to undo"));
  EXPECT_EQ(RunJson({"skin", "bind",
                     "skins/my-arm@2"})["binding"]["counts"]["userCount"],
            10);
  EXPECT_THAT(Run({"skin", "bind", "skins/my-arm", "--keep", "other"}).err,
              HasSubstr("--keep: skins/my-arm is there already"));
  const json list = RunJson({"skin", "list"});
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0]["name"], "skins/my-arm");
  EXPECT_THAT(Run({"skin", "list"}).out, HasSubstr("skins/my-arm"));
  EXPECT_EQ(Run({"skin", "delete", "skins/my-arm"}).exit_code, 0);
  EXPECT_TRUE(RunJson({"skin", "list"}).empty());
  EXPECT_EQ(Run({"skin", "delete", "skins/my-arm"}).exit_code, 1);
}

TEST_F(CommandLineTest, WithoutAServerNoSkinStays) {
  EXPECT_THAT(Run({"skin", "bind", "arm", "--keep", "my-arm"}).err,
              HasSubstr("--keep: want a --server"));
  EXPECT_THAT(Run({"skin", "list"}).err, HasSubstr("--server"));
}

}  // namespace
}  // namespace gelenk
