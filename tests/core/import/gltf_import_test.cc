#include "gelenk/import/gltf_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "tests/core/import/gltf_oracle.h"
#include "tests/testing/gltf_files.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"

namespace gelenk {
namespace {

using ::gelenk::testing::BodyGltf;
using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::GltfOracle;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

// Products of some ten transforms of metres, with quaternions of 15 digits.
constexpr double kRounding = 1e-13;

GltfDocument Read(absl::string_view text) {
  absl::StatusOr<GltfDocument> document = ReadGltf(text);
  EXPECT_TRUE(document.ok()) << document.status();
  return document.ok() ? *std::move(document) : GltfDocument();
}

GltfImport Import(absl::string_view text,
                  const GltfImportOptions& options = {}) {
  absl::StatusOr<GltfImport> import = ImportGltf(Read(text), options);
  EXPECT_TRUE(import.ok()) << import.status();
  return *std::move(import);
}

std::string Message(absl::string_view text,
                    const GltfImportOptions& options = {}) {
  const absl::Status status = ImportGltf(Read(text), options).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  return std::string(status.message());
}

std::string Gltf(absl::string_view nodes, absl::string_view more = "") {
  return absl::StrCat("{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [", nodes,
                      "]", more, "}");
}

std::vector<std::string> JointIds(const GltfImport& import) {
  std::vector<std::string> ids;
  for (const Joint& joint : import.skeleton->joints()) ids.push_back(joint.id);
  return ids;
}

std::vector<std::string> EndEffectorIds(const GltfImport& import) {
  std::vector<std::string> ids;
  for (const EndEffector& effector : import.skeleton->end_effectors()) {
    ids.push_back(effector.id);
  }
  return ids;
}

Eigen::Vector3d RestPosition(const GltfImport& import, absl::string_view id) {
  return EffectorPose(*import.skeleton, import.skeleton->rest_positions(), id)
      .translation;
}

// Joints are where the format says in any pose. The root rests, turned only:
// its coordinates are those of the world.
void ExpectJointsWhereTheFileSays(const std::string& text,
                                  const GltfImport& import) {
  const GltfOracle oracle(text);
  const Skeleton& skeleton = *import.skeleton;
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::VectorXd pose = RandomPose(random, skeleton);
    std::map<int, Eigen::Matrix3d> turns;
    for (size_t node = 0; node < import.joint_of_node.size(); ++node) {
      const int joint = import.joint_of_node[node];
      if (joint < 0) continue;
      int at = skeleton.span(joint).position_offset;
      Eigen::Quaterniond rest = Eigen::Quaterniond::Identity();
      if (skeleton.joint(joint).type == JointType::kFree) {
        pose.segment<3>(at) = skeleton.rest_positions().segment<3>(at);
        at += 3;
        rest = QuaternionXyzw(skeleton.rest_positions().data() + at);
      }
      const Eigen::Quaterniond q = QuaternionXyzw(pose.data() + at);
      turns[static_cast<int>(node)] = (rest.conjugate() * q).toRotationMatrix();
    }
    WorldTransforms frames;
    ForwardKinematics(skeleton, pose, frames);
    for (size_t node = 0; node < import.joint_of_node.size(); ++node) {
      const int joint = import.joint_of_node[node];
      if (joint < 0) continue;
      const Eigen::Matrix4d expected =
          oracle.SceneFromNode(static_cast<int>(node), turns);
      EXPECT_LT(
          (frames[joint].translation - expected.topRightCorner<3, 1>()).norm(),
          kRounding)
          << node;
      EXPECT_LT((frames[joint].rotation.matrix() -
                 expected.topLeftCorner<3, 3>().colwise().normalized())
                    .norm(),
                kRounding)
          << node;
    }
  }
}

TEST(GltfImportTest, ASkinIsASkeleton) {
  const GltfImport import = Import(BodyGltf());
  EXPECT_THAT(JointIds(import),
              ElementsAre("Hips", "Spine", "Head", "LeftHand", "RightHand"));
  EXPECT_THAT(import.joint_of_node, ElementsAre(-1, 0, 1, 2, 3, 4, -1, -1));
  const Skeleton& skeleton = *import.skeleton;
  EXPECT_EQ(skeleton.joint(0).type, JointType::kFree);
  EXPECT_EQ(skeleton.joint(0).parent_id, "");
  for (int i = 1; i < skeleton.joint_count(); ++i) {
    EXPECT_EQ(skeleton.joint(i).type, JointType::kSpherical);
  }
  EXPECT_EQ(skeleton.joint(4).parent_id, "Spine");
  EXPECT_EQ(skeleton.up(), Eigen::Vector3d::UnitY());
  // The skinned mesh is none.
  EXPECT_THAT(EndEffectorIds(import), ElementsAre("HeadTop"));
  EXPECT_THAT(import.warnings,
              ElementsAre("1 nodes are scaled, the first is nodes[0] "
                          "(\"Armature\") by 0.01: lengths are those of the "
                          "scene"));
}

TEST(GltfImportTest, JointsAreWhereTheFileSays) {
  ExpectJointsWhereTheFileSays(BodyGltf(), Import(BodyGltf()));
}

TEST(GltfImportTest, ScalesOnTheWayCount) {
  const std::string text = Gltf(
      R"({"children": [1], "scale": [2, 2, 2], "translation": [1, 0, 0],
          "rotation": [0.6, 0, 0, 0.8]},
         {"children": [2], "scale": [0.5, 0.5, 0.5], "translation": [0, 1, 0],
          "rotation": [0, 0.6, 0, -0.8]},
         {"children": [3], "scale": [-3, -3, 3], "translation": [0, 1, 2]},
         {"translation": [0.5, 0.25, 0], "scale": [7, 1, -1]})",
      R"(, "skins": [{"joints": [0, 1, 2, 3]}])");
  const GltfImport import = Import(text);
  EXPECT_THAT(import.warnings, Contains(HasSubstr("3 nodes are scaled")));
  const GltfOracle oracle(text);
  for (int node : {0, 1, 2, 3}) {
    EXPECT_LT((RestPosition(import, absl::StrCat("node", node)) -
               oracle.SceneFromNode(node).topRightCorner<3, 1>())
                  .norm(),
              kRounding);
  }
}

TEST(GltfImportTest, TheRootIsInTheWorld) {
  const GltfImport import = Import(BodyGltf());
  const Eigen::VectorXd& rest = import.skeleton->rest_positions();
  ASSERT_EQ(rest.size(), 7 + 4 * 4);
  // 95 cm along Z, which the armature turns to Y, and half a metre to the side.
  EXPECT_LT((rest.head<3>() - Eigen::Vector3d(0.5, 0.95, 0)).norm(), kRounding);
  EXPECT_TRUE(
      import.skeleton->joint(0).parent_from_joint.translation.isZero(0));
  EXPECT_EQ(rest.tail<4>(), Eigen::Vector4d(0, 0, 0, 1));
}

TEST(GltfImportTest, UnevenScalesAreExactAtRest) {
  const std::string text = Gltf(
      R"({"children": [1], "scale": [1, 2, 1]},
         {"children": [2], "translation": [0, 1, 0], "rotation": [0, 0, 0.6, 0.8]},
         {"name": "tip", "translation": [0, 1, 0]})");
  const GltfImport import = Import(text);
  EXPECT_LT((RestPosition(import, "tip") -
             GltfOracle(text).SceneFromNode(2).topRightCorner<3, 1>())
                .norm(),
            kRounding);
  EXPECT_THAT(import.warnings,
              Contains(HasSubstr("not scaled alike along all axes, the first "
                                 "is nodes[0] by (1, 2, 1)")));
  // From both sides of what is rounding.
  EXPECT_THAT(Import(Gltf(R"({"children": [1], "scale": [1, 1.00009, 1]}, {})"))
                  .warnings,
              SizeIs(1));
  EXPECT_THAT(Import(Gltf(R"({"children": [1], "scale": [1, 1.00011, 1]}, {})"))
                  .warnings,
              SizeIs(2));
}

TEST(GltfImportTest, ShearIsTold) {
  const auto warnings = [](const char* lean) {
    return Import(Gltf(absl::StrCat(
                      R"({"children": [1], "matrix": [1, 0, 0, 0, )", lean,
                      ", 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}, {}")))
        .warnings;
  };
  EXPECT_THAT(warnings("0.0009"), SizeIs(1));
  EXPECT_THAT(warnings("0.0011"), Contains(HasSubstr("sheared")));
}

TEST(GltfImportTest, WhatIsMirroredIsRefused) {
  const char kSkin[] = R"(, "skins": [{"joints": [1]}])";
  EXPECT_EQ(Message(Gltf(R"({"name": "Arm", "children": [1],
                             "scale": [-1, 1, 1]}, {})",
                         kSkin)),
            "nodes[0] (\"Arm\").scale: (-1, 1, 1) mirrors what is below, which "
            "has then no rigid frames");
  EXPECT_THAT(
      Message(Gltf(R"({"children": [1], "scale": [-1, -1, -1]}, {})", kSkin)),
      HasSubstr("mirrors"));
  // Nothing is below, or to the side.
  EXPECT_THAT(JointIds(Import(Gltf(R"({"scale": [-1, 1, 1], "children": [2]},
                                      {"scale": [1, -1, 1]}, {})",
                                   kSkin))),
              ElementsAre("node1"));
}

TEST(GltfImportTest, TheLargestSkinIsTakenUnlessOneIsNamed) {
  const std::string text = Gltf(
      R"({"children": [1], "name": "a"}, {"name": "b"},
         {"children": [3], "name": "c"}, {"children": [4], "name": "d"},
         {"name": "e"})",
      R"(, "skins": [{"name": "two", "joints": [0, 1]},
                     {"joints": [2, 3, 4]}])");
  const GltfImport largest = Import(text);
  EXPECT_THAT(JointIds(largest), ElementsAre("c", "d", "e"));
  EXPECT_THAT(largest.warnings,
              ElementsAre("skin 1 is taken, with the most joints, 3; there are "
                          "skin \"two\", skin 1"));
  const GltfImport named = Import(text, {.skin = "two"});
  EXPECT_THAT(JointIds(named), ElementsAre("a", "b"));
  EXPECT_THAT(named.warnings, IsEmpty());
  EXPECT_THAT(JointIds(Import(text, {.skin = "1"})),
              ElementsAre("c", "d", "e"));
  EXPECT_EQ(Message(text, {.skin = "2"}),
            "skin: there is none called \"2\"; there are skin \"two\", skin 1");
  EXPECT_EQ(Message(Gltf("{}"), {.skin = "x"}),
            "skin: there is none called \"x\"");
}

TEST(GltfImportTest, SkinsThatShareJointsAreOneBody) {
  const GltfImport import = Import(
      Gltf(R"({"children": [1]}, {"children": [2]}, {"children": [3]}, {})",
           R"(, "skins": [{"joints": [0, 1]}, {"joints": [2, 1]},
                          {"joints": [3, 2]}])"));
  EXPECT_THAT(JointIds(import),
              ElementsAre("node0", "node1", "node2", "node3"));
  EXPECT_THAT(import.warnings, IsEmpty());
}

TEST(GltfImportTest, JointsWithoutACommonOneGetTheNodeAbove) {
  const std::string text = Gltf(
      R"({"children": [1], "name": "Scene"},
         {"children": [2, 3], "name": "Rig", "translation": [0, 1, 0]},
         {"name": "a", "translation": [1, 0, 0]},
         {"children": [4], "name": "Control", "translation": [0, 0, 2]},
         {"name": "b", "translation": [0, 1, 0]})",
      R"(, "skins": [{"joints": [4, 2]}])");
  const GltfImport import = Import(text);
  // The file's order below the root; what lies between is folded.
  EXPECT_THAT(JointIds(import), ElementsAre("Rig", "a", "b"));
  EXPECT_EQ(import.skeleton->joint(0).type, JointType::kFree);
  EXPECT_EQ(import.skeleton->joint(2).parent_from_joint.translation,
            Eigen::Vector3d(0, 1, 2));
  ExpectJointsWhereTheFileSays(text, import);
}

TEST(GltfImportTest, JointsOfSeveralTreesGetARoot) {
  const std::string text =
      Gltf(R"({"name": "a", "translation": [1, 0, 0]},
              {"name": "b", "children": [2], "translation": [2, 0, 0]},
              {"name": "c", "translation": [0, 3, 0]})",
           R"(, "skins": [{"name": "both", "joints": [0, 1, 2]}])");
  const GltfImport import = Import(text);
  EXPECT_THAT(JointIds(import), ElementsAre("both", "a", "b", "c"));
  EXPECT_THAT(import.joint_of_node, ElementsAre(1, 2, 3));
  EXPECT_EQ(import.skeleton->joint(0).type, JointType::kFixed);
  EXPECT_EQ(import.skeleton->joint(1).type, JointType::kFree);
  EXPECT_EQ(import.skeleton->joint(2).type, JointType::kFree);
  EXPECT_EQ(import.skeleton->joint(3).type, JointType::kSpherical);
  EXPECT_THAT(import.warnings,
              ElementsAre("several joints hang from nothing: \"both\" is a "
                          "root for them"));
  ExpectJointsWhereTheFileSays(text, import);
}

TEST(GltfImportTest, NodesBetweenJointsAreJointsWhereTheyTurn) {
  const std::string nodes =
      R"({"name": "hip", "children": [1]},
         {"name": "twist", "children": [2], "translation": [0, -0.4, 0],
          "rotation": [0, 0, 0.6, 0.8]},
         {"name": "foot", "translation": [0, -0.5, 0]})";
  const std::string skins = R"(, "skins": [{"joints": [0, 2]}])";
  const GltfImport still = Import(Gltf(nodes, skins));
  EXPECT_THAT(JointIds(still), ElementsAre("hip", "foot"));
  EXPECT_THAT(still.warnings,
              ElementsAre("1 nodes between joints are part of the joints below "
                          "them"));
  // It can be named all the same.
  EXPECT_THAT(EndEffectorIds(still), ElementsAre("twist"));

  const std::string text =
      Gltf(nodes, absl::StrCat(skins, R"(, "animations": [{"channels": [
                   {"target": {"node": 1, "path": "rotation"}}]}])"));
  const GltfImport turned = Import(text);
  EXPECT_THAT(JointIds(turned), ElementsAre("hip", "twist", "foot"));
  EXPECT_THAT(turned.warnings, IsEmpty());
  ExpectJointsWhereTheFileSays(text, turned);
}

TEST(GltfImportTest, WithoutSkinsTheSceneIsASkeleton) {
  const std::string nodes =
      R"({"name": "a", "children": [1]}, {"name": "b"}, {"name": "c"})";
  const GltfImport import =
      Import(Gltf(nodes, R"(, "scenes": [{"nodes": [2]}, {"nodes": [0]}],
                     "scene": 1)"));
  EXPECT_THAT(JointIds(import), ElementsAre("a", "b"));
  EXPECT_THAT(import.warnings,
              ElementsAre("there is no skin: every node of the scene is a "
                          "joint"));
  // Without scenes every node counts.
  EXPECT_THAT(JointIds(Import(Gltf(nodes))),
              ElementsAre("root", "a", "b", "c"));
  EXPECT_THAT(Message(Gltf("")), HasSubstr("nodes: there is none"));
  EXPECT_THAT(Message(Gltf("{}", R"(, "scenes": [{}])")),
              HasSubstr("the scene shows no node"));
}

TEST(GltfImportTest, NamesAreMadeUniqueAndTold) {
  const std::string long_name(70, 'x');
  const GltfImport import = Import(
      Gltf(absl::StrCat(R"({"name": "arm", "children": [1, 2, 3, 4]},
                      {"name": "arm"}, {},
                      {"name": "tab\there"}, {"name": ")",
                        long_name, R"(", "children": [5]}, {"name": "arm"})"),
           R"(, "skins": [{"joints": [0, 1, 2, 3, 4]}])"));
  EXPECT_THAT(JointIds(import),
              ElementsAre("arm", "arm#2", "node2", "tab\xEF\xBF\xBDhere",
                          std::string(63, 'x')));
  EXPECT_THAT(EndEffectorIds(import), ElementsAre("arm#3"));
  EXPECT_THAT(
      import.warnings,
      ElementsAre("node 1, \"arm\", is called \"arm#2\"", HasSubstr("node 3"),
                  HasSubstr("node 4"), "node 5, \"arm\", is called \"arm#3\""));
}

TEST(GltfImportTest, EndEffectorsAreBounded) {
  std::string nodes =
      R"({"name": "hip", "children": [1, 2, 3, 4]}, {"name": "a"},
                         {"name": "b"}, {}, {"name": "c"})";
  GltfImportOptions options;
  options.bounds.max_end_effectors = 3;
  const std::string text = Gltf(nodes, R"(, "skins": [{"joints": [0]}])");
  EXPECT_THAT(EndEffectorIds(Import(text, options)),
              ElementsAre("a", "b", "c"));
  EXPECT_THAT(Import(text, options).warnings, IsEmpty());
  options.bounds.max_end_effectors = 2;
  EXPECT_THAT(EndEffectorIds(Import(text, options)), ElementsAre("a", "b"));
  EXPECT_THAT(Import(text, options).warnings,
              ElementsAre("1 nodes below joints are no end effectors: there "
                          "are 2 already"));
}

TEST(GltfImportTest, JointsAreBounded) {
  GltfImportOptions options;
  options.bounds.max_joints = 5;
  EXPECT_THAT(JointIds(Import(BodyGltf(), options)), SizeIs(5));
  options.bounds.max_joints = 4;
  EXPECT_EQ(Message(BodyGltf(), options), "joints: want at most 4, got 5");
}

TEST(GltfImportTest, LengthsComeInTheGivenUnit) {
  const GltfImport import = Import(BodyGltf(), {.unit_m = 0.5});
  EXPECT_LT((import.skeleton->rest_positions().head<3>() -
             Eigen::Vector3d(0.25, 0.475, 0))
                .norm(),
            kRounding);
  EXPECT_LT((RestPosition(import, "HeadTop") -
             0.5 * RestPosition(Import(BodyGltf()), "HeadTop"))
                .norm(),
            kRounding);
  for (double unit_m : {0.0, -1.0, 1e7, double{NAN}, double{INFINITY}}) {
    EXPECT_THAT(Message(BodyGltf(), {.unit_m = unit_m}),
                StartsWith("unit_m: "));
  }
}

TEST(GltfImportTest, GiantsAreTold) {
  const auto warnings = [](const char* height) {
    return Import(
               Gltf(absl::StrCat(R"({"children": [1]}, {"translation": [0, )",
                                 height, ", 0]}"),
                    R"(, "skins": [{"joints": [0, 1]}])"))
        .warnings;
  };
  EXPECT_THAT(warnings("19.9"), IsEmpty());
  EXPECT_THAT(warnings("20.1"), ElementsAre(HasSubstr("20.1 m large")));
}

TEST(GltfImportTest, WhatIsBeyondReckoningIsRefused) {
  std::string nodes;
  for (int i = 1; i < 60; ++i) {
    absl::StrAppend(&nodes, R"({"scale": [1e9, 1e9, 1e9], "children": [)", i,
                    R"(], "translation": [1, 1, 1]}, )");
  }
  EXPECT_THAT(Message(Gltf(nodes + "{}")),
              StartsWith("nodes[1]: more than 1e+09 m from the origin"));
}

}  // namespace
}  // namespace gelenk
