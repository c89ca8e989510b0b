#include "gelenk/import/gltf_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/substitute.h"
#include "tests/testing/gltf_files.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::BodyGltf;
using ::gelenk::testing::Glb;
using ::gelenk::testing::LittleEndian;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

constexpr double kRounding = 1e-14;

GltfDocument Read(absl::string_view bytes) {
  absl::StatusOr<GltfDocument> document = ReadGltf(bytes);
  EXPECT_TRUE(document.ok()) << document.status();
  return document.ok() ? *std::move(document) : GltfDocument();
}

std::string Message(absl::string_view bytes, const GltfBounds& bounds = {}) {
  const absl::Status status = ReadGltf(bytes, bounds).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  return std::string(status.message());
}

// Members of the root beside the asset.
std::string Gltf(absl::string_view members) {
  return absl::StrCat("{\"asset\": {\"version\": \"2.0\"}, ", members, "}");
}

std::string Nodes(absl::string_view nodes) {
  return Gltf(absl::StrCat("\"nodes\": [", nodes, "]"));
}

std::vector<std::string> Lines(absl::string_view text) {
  return ViolationLines(ReadGltf(text).status());
}

GltfNode ReadNode(absl::string_view node) {
  const GltfDocument document = Read(Nodes(node));
  EXPECT_THAT(document.nodes, SizeIs(1));
  return document.nodes.empty() ? GltfNode() : document.nodes[0];
}

TEST(GltfReaderTest, ReadsNodesSkinsAndScenes) {
  const GltfDocument document = Read(BodyGltf());
  ASSERT_THAT(document.nodes, SizeIs(8));
  EXPECT_EQ(document.nodes[0].name, "Armature");
  EXPECT_EQ(document.nodes[0].parent, -1);
  EXPECT_THAT(document.nodes[0].children, ElementsAre(1, 7));
  EXPECT_EQ(document.nodes[2].parent, 1);
  EXPECT_EQ(document.nodes[2].translation, Eigen::Vector3d(0, 20, 1));
  EXPECT_EQ(document.nodes[4].rotation.z(), 0.6);
  EXPECT_TRUE(document.nodes[7].has_skin);
  EXPECT_FALSE(document.nodes[6].has_skin);
  ASSERT_THAT(document.skins, SizeIs(1));
  EXPECT_EQ(document.skins[0].name, "Body");
  EXPECT_THAT(document.skins[0].joints, ElementsAre(1, 2, 3, 4, 5));
  ASSERT_THAT(document.scenes, SizeIs(1));
  EXPECT_THAT(document.scenes[0].roots, ElementsAre(0));
  EXPECT_EQ(document.scene, 0);
}

TEST(GltfReaderTest, AGlbReadsLikeItsJson) {
  const GltfDocument document = Read(Glb(BodyGltf(), "mesh"));
  EXPECT_THAT(document.nodes, SizeIs(8));
  EXPECT_EQ(document.nodes[6].name, "HeadTop");
}

TEST(GltfReaderTest, EveryPieceOfAGlbIsRefused) {
  const std::string glb = Glb(Nodes("{}"), "mesh");
  EXPECT_TRUE(ReadGltf(glb).ok());
  for (size_t size = 0; size < glb.size(); ++size) {
    EXPECT_FALSE(ReadGltf(glb.substr(0, size)).ok()) << size;
  }
  EXPECT_EQ(Message(glb.substr(0, 19)),
            "GLB: cut off in its header, after 19 bytes");
  EXPECT_EQ(Message(glb.substr(0, glb.size() - 1)),
            absl::StrCat("GLB: cut off: its header says ", glb.size(),
                         " bytes, there are ", glb.size() - 1));
}

TEST(GltfReaderTest, MalformedGlbsSayWhy) {
  std::string glb = Glb(Nodes("{}"));
  const auto with = [&glb](size_t at, const std::string& bytes) {
    return std::string(glb).replace(at, bytes.size(), bytes);
  };
  EXPECT_EQ(Message(with(4, LittleEndian(1))), "GLB: want version 2, got 1");
  EXPECT_THAT(Message(with(8, LittleEndian(0xFFFFFFFF))),
              HasSubstr("its header says 4294967295 bytes"));
  EXPECT_THAT(Message(with(12, LittleEndian(0xFFFFFFFF))),
              HasSubstr("its JSON has 4294967295 bytes"));
  EXPECT_EQ(Message(with(16, "BIN ")), "GLB: its first chunk is no JSON");
  EXPECT_THAT(Message(with(12, LittleEndian(0))),
              HasSubstr("no well-formed JSON"));
}

TEST(GltfReaderTest, MalformedJsonIsToldByPlace) {
  EXPECT_THAT(Message("{\"asset\":\n  nonsense}"),
              StartsWith("no well-formed JSON: parse error at line 2, column "
                         "4"));
  EXPECT_THAT(Message(""), StartsWith("no well-formed JSON"));
  EXPECT_THAT(Message("{\"asset\": NaN}"), HasSubstr("no well-formed JSON"));
  EXPECT_THAT(Message("{\"a\": \"\xFF\"}"), HasSubstr("no well-formed JSON"));
  EXPECT_LT(Message(absl::StrCat("{", std::string(5000, 'x'))).size(), 300);
  EXPECT_EQ(Message("[]"), "want a JSON object: this is no glTF");
}

TEST(GltfReaderTest, OnlyVersionTwoIsRead) {
  EXPECT_EQ(Message("{}"), "asset.version: missing: this is no glTF");
  EXPECT_EQ(Message(R"({"asset": {"version": "1.0"}})"),
            "asset.version: want 2.0, got \"1.0\"");
  EXPECT_EQ(Message(R"({"asset": {"version": 2.0}})"),
            "asset.version: missing: this is no glTF");
  EXPECT_TRUE(ReadGltf(R"({"asset": {"version": "2.1"}})").ok());
}

TEST(GltfReaderTest, AByteOrderMarkIsFine) {
  EXPECT_THAT(Read(absl::StrCat("\xEF\xBB\xBF", Nodes("{}"))).nodes, SizeIs(1));
}

TEST(GltfReaderTest, OtherFilesAreNotLookedAt) {
  // Nothing decodes or opens what is behind these.
  EXPECT_THAT(
      Read(Gltf(R"("nodes": [{"mesh": 7}], "images": [{"uri": "/dev/zero"}],
                   "buffers": [{"uri": "data:;base64,????",
                                "byteLength": 1e300}],
                   "accessors": "none", "extensions": {"nodes": [[]]})"))
          .nodes,
      SizeIs(1));
}

TEST(GltfReaderTest, AMatrixIsTakenApart) {
  // A quarter turn about Z, 2, 3 and 4 times as large.
  const GltfNode node = ReadNode(
      R"({"matrix": [0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 5, 6, 7, 1]})");
  EXPECT_EQ(node.translation, Eigen::Vector3d(5, 6, 7));
  EXPECT_EQ(node.scale, Eigen::Vector3d(2, 3, 4));
  EXPECT_LT(node.rotation.angularDistance(Eigen::Quaterniond(
                Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()))),
            kRounding);
  EXPECT_EQ(node.shear, 0);
}

TEST(GltfReaderTest, ShearIsMeasured) {
  // The second axis leans by atan(1/2) towards the first.
  const GltfNode node = ReadNode(
      R"({"matrix": [1, 0, 0, 0, 1, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]})");
  EXPECT_NEAR(node.shear, 1 / std::sqrt(5), kRounding);
  const GltfNode flat = ReadNode(
      R"({"matrix": [1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]})");
  EXPECT_EQ(flat.shear, 1);
}

TEST(GltfReaderTest, TwoNegativeScalesAreATurn) {
  const GltfNode turned = ReadNode(R"({"scale": [-2, 3, -4]})");
  EXPECT_EQ(turned.scale, Eigen::Vector3d(2, 3, 4));
  EXPECT_LT(
      (turned.rotation * Eigen::Vector3d(1, 1, 1) - Eigen::Vector3d(-1, 1, -1))
          .norm(),
      kRounding);
  EXPECT_EQ(ReadNode(R"({"scale": [2, 3, -4]})").scale,
            Eigen::Vector3d(2, 3, -4));
  EXPECT_EQ(ReadNode(R"({"scale": [-2, -3, -4]})").scale,
            Eigen::Vector3d(-2, -3, -4));
  const GltfNode mirrored = ReadNode(
      R"({"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1]})");
  EXPECT_LT(mirrored.scale.prod(), 0);
}

TEST(GltfReaderTest, MatricesStandAloneAndAreAffine) {
  EXPECT_THAT(
      Lines(Nodes(
          R"({"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "scale": [1,1,1]})")),
      ElementsAre(
          "nodes[0].matrix: together with translation, rotation or scale"));
  EXPECT_THAT(
      Lines(Nodes(R"({"matrix": [1,0,0,0.1, 0,1,0,0, 0,0,1,0, 0,0,0,1]})")),
      ElementsAre("nodes[0].matrix: its last row is not (0, 0, 0, 1)"));
}

TEST(GltfReaderTest, QuaternionsAreNearUnit) {
  EXPECT_NEAR(ReadNode(R"({"rotation": [0, 0, 0, 1.0009]})").rotation.w(), 1,
              kRounding);
  EXPECT_THAT(Lines(Nodes(R"({"rotation": [0, 0, 0, 1.0011]})")),
              ElementsAre("nodes[0].rotation: want a unit quaternion, got (0, "
                          "0, 0, 1.0011)"));
  EXPECT_THAT(Lines(Nodes(R"({"rotation": [0, 0, 0, 0]})")), SizeIs(1));
}

TEST(GltfReaderTest, ListsEveryFaultByItsPath) {
  EXPECT_THAT(
      Lines(Gltf(R"("nodes": [
          {"name": 5, "translation": "abc"},
          7,
          {"translation": [1, 2], "rotation": [0, 0, "x", 1]},
          {"scale": [1, 1, 2e9], "children": {}}],
        "skins": [{"joints": []}, {}], "scenes": 3,
        "animations": [{"channels": [{"target": {"node": 4}}]}])")),
      ElementsAre("nodes[0].name: want a string",
                  "nodes[0].translation: want 3 numbers",
                  "nodes[1]: want an object",
                  "nodes[2].translation: want 3 numbers",
                  "nodes[2].rotation[2]: want a number of at most 1e9",
                  "nodes[3].children: want an array",
                  "nodes[3].scale[2]: want a number of at most 1e9",
                  "skins[0]: no joints", "skins[1]: no joints",
                  "animations[0].channels[0].target.node: want a node, 0 to 3, "
                  "got 4",
                  "scenes: want an array"));
}

TEST(GltfReaderTest, IndicesAreThoseOfNodes) {
  for (const char* index : {"2", "-1", "0.5", "1e300", "-1e300",
                            "18446744073709551615", "4294967296"}) {
    EXPECT_THAT(
        Lines(Nodes(absl::StrCat(R"({"children": [)", index, "]}, {}"))),
        ElementsAre(
            StartsWith("nodes[0].children[0]: want a node, 0 to 1, got ")))
        << index;
  }
  EXPECT_THAT(Lines(Nodes(R"({"children": ["1"]}, {})")),
              ElementsAre("nodes[0].children[0]: want the index of a node"));
  EXPECT_THAT(Lines(Gltf(R"("scenes": [{"nodes": [0]}])")),
              ElementsAre("scenes[0].nodes[0]: there is no node"));
  EXPECT_THAT(
      Lines(Gltf(R"("nodes": [{}], "skins": [{"joints": [0, 1]}])")),
      ElementsAre(HasSubstr("skins[0].joints[1]: want a node, 0 to 0")));
  EXPECT_THAT(Lines(Gltf(R"("nodes": [{}], "scenes": [{}], "scene": 1)")),
              ElementsAre("scene: want a scene, 0 to 0, got 1"));
  // Written with a point, it is the same number.
  EXPECT_THAT(Read(Nodes(R"({"children": [1.0]}, {})")).nodes[0].children,
              ElementsAre(1));
}

TEST(GltfReaderTest, NodesAreAForest) {
  EXPECT_THAT(Lines(Nodes(R"({"children": [2]}, {"children": [2]}, {})")),
              ElementsAre("nodes[1].children: node 2 is a child of node 0 "
                          "already"));
  EXPECT_THAT(Lines(Nodes(R"({"children": [1, 1]}, {})")), SizeIs(2));
  EXPECT_THAT(Lines(Nodes(R"({"children": [0]})")),
              ElementsAre("nodes[0]: its own ancestor, or below a node that "
                          "is"));
  EXPECT_THAT(Lines(Nodes(R"({}, {"children": [2]}, {"children": [3]},
                             {"children": [1]})")),
              ElementsAre(StartsWith("nodes[1]: its own ancestor")));
  EXPECT_THAT(Lines(Gltf(R"("nodes": [{"children": [1]}, {}],
                            "scenes": [{"nodes": [0, 1]}])")),
              ElementsAre("scenes[0].nodes: node 1 is no root but a child of "
                          "node 0"));
}

TEST(GltfReaderTest, AnimationsTellWhatTurns) {
  const GltfDocument document = Read(Gltf(R"("nodes": [{}, {}, {}],
      "animations": [{"samplers": [{}], "channels": [
        {"sampler": 0, "target": {"node": 0, "path": "translation"}},
        {"sampler": 0, "target": {"node": 1, "path": "rotation"}},
        {"sampler": 0, "target": {"path": "pointer"}}]}])"));
  EXPECT_FALSE(document.nodes[0].is_turned);
  EXPECT_TRUE(document.nodes[1].is_turned);
  EXPECT_FALSE(document.nodes[2].is_turned);
}

TEST(GltfReaderTest, NestingIsBounded) {
  const auto nested = [](int depth) {
    return Gltf(absl::StrCat("\"nodes\": [{}], \"extras\": ",
                             std::string(depth, '['), std::string(depth, ']')));
  };
  // The root is a level, too.
  EXPECT_THAT(Read(nested(63)).nodes, SizeIs(1));
  EXPECT_EQ(Message(nested(64)), "JSON: want at most 64 levels");
  EXPECT_EQ(Message(nested(1'000'000)), "JSON: want at most 64 levels");
  // Brackets in strings nest nothing.
  EXPECT_THAT(Read(Nodes(absl::StrCat("{\"name\": \"\\\"", std::string(99, '['),
                                      "\"}")))
                  .nodes,
              SizeIs(1));
}

TEST(GltfReaderTest, ADeepTreeOfNodesIsFine) {
  std::string nodes;
  constexpr int kDepth = 60'000;
  for (int i = 1; i < kDepth; ++i) {
    absl::StrAppend(&nodes, "{\"children\":[", i, "]},");
  }
  EXPECT_THAT(Read(Nodes(nodes + "{}")).nodes, SizeIs(kDepth));
}

TEST(GltfReaderTest, SizesAreBoundedOnBothSides) {
  const std::string text = Nodes("{}, {}, {}");
  GltfBounds bounds;
  bounds.max_bytes = bounds.max_json_bytes = text.size();
  bounds.max_json_depth = 3;
  // The root, the asset, its version, the nodes and three of them.
  bounds.max_json_values = 7;
  bounds.max_nodes = 3;
  EXPECT_TRUE(ReadGltf(text, bounds).ok());
  const auto message = [&](size_t GltfBounds::*member) {
    GltfBounds tighter = bounds;
    --(tighter.*member);
    return Message(text, tighter);
  };
  EXPECT_THAT(message(&GltfBounds::max_bytes), StartsWith("want at most "));
  EXPECT_THAT(message(&GltfBounds::max_json_bytes),
              StartsWith("JSON: want at most "));
  EXPECT_EQ(message(&GltfBounds::max_json_depth),
            "JSON: want at most 2 levels");
  EXPECT_EQ(message(&GltfBounds::max_json_values),
            "JSON: want at most 6 values");
  EXPECT_EQ(message(&GltfBounds::max_nodes), "nodes: want at most 2, got 3");
}

TEST(GltfReaderTest, AMillionFaultsAreCounted) {
  std::string children = "9";
  for (int i = 1; i < 1'000'000; ++i) children += ",9";
  EXPECT_THAT(Message(Nodes(absl::StrCat("{\"children\":[", children, "]}"))),
              HasSubstr("; and 999980 more"));
}

std::vector<std::string> HumanoidOf(absl::string_view extensions) {
  const GltfDocument document = Read(Gltf(absl::StrCat(
      "\"nodes\": [{}, {}, {}], \"extensions\": {", extensions, "}")));
  std::vector<std::string> bones;
  for (const GltfHumanBone& bone : document.humanoid) {
    bones.push_back(absl::StrCat(bone.bone, "=", bone.node));
  }
  return bones;
}

TEST(GltfReaderTest, AVrmSaysWhichNodeIsWhichBone) {
  const std::string vrm0 =
      "\"VRM\": {\"humanoid\": {\"humanBones\": ["
      "{\"bone\": \"hips\", \"node\": 2, \"useDefaultValues\": true}, "
      "{\"bone\": \"leftEye\", \"node\": 0}, "
      "{\"bone\": \"leftUpperArm\", \"node\": 1}]}}";
  const std::string vrm1 =
      "\"VRMC_vrm\": {\"specVersion\": \"1.0\", \"humanoid\": "
      "{\"humanBones\": {\"hips\": {\"node\": 2}, "
      "\"leftThumbDistal\": {\"node\": 0}, "
      "\"leftUpperArm\": {\"node\": 1}}}}";
  // Bones without a role are of no use.
  EXPECT_THAT(HumanoidOf(vrm0), ElementsAre("hips=2", "leftUpperArm=1"));
  EXPECT_THAT(HumanoidOf(vrm1), ElementsAre("hips=2", "leftUpperArm=1"));
  EXPECT_THAT(HumanoidOf(""), IsEmpty());
}

TEST(GltfReaderTest, AVrmBoneWithoutANodeIsNamed) {
  const std::string file = Gltf(
      "\"nodes\": [{}], \"extensions\": {\"VRMC_vrm\": {\"humanoid\": "
      "{\"humanBones\": {\"head\": {\"node\": 7}}}}}");
  EXPECT_THAT(
      Lines(file),
      ElementsAre("extensions.VRMC_vrm.humanoid.humanBones.head.node: want a "
                  "node, 0 to 0, got 7"));
}

}  // namespace
}  // namespace gelenk
