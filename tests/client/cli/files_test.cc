#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/file_bytes.h"
#include "client/cli/info/inspection.h"
#include "client/cli/motion/body_file.h"
#include "client/cli/skeleton_file.h"
#include "convert/skeleton.h"
#include "gelenk/retarget/humanoid.h"
#include "tests/testing/gltf_files.h"
#include "tests/testing/gripper_arm_urdf.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class FilesTest : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Path(const std::string& name) const {
    return (folder_ / name).string();
  }
  std::string Write(const std::string& name, const std::string& text) {
    EXPECT_TRUE(WriteFile(Path(name), text).ok());
    return Path(name);
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) /
      ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(FilesTest, BytesComeRound) {
  const std::string bytes("a\0b\r\n", 5);
  EXPECT_EQ(*ReadFile(Write("bytes", bytes)), bytes);
}

TEST_F(FilesTest, ErrorsNameTheFile) {
  const absl::Status missing = ReadFile(Path("missing")).status();
  EXPECT_EQ(missing.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(missing.message()), HasSubstr("missing"));
  EXPECT_FALSE(ReadFile(folder_.string()).ok());
  EXPECT_FALSE(WriteFile(Path("no/such/folder"), "").ok());
}

TEST_F(FilesTest, ReadsABvhWithItsClip) {
  const auto file = ReadSkeletonFile(
      Write("walk.bvh", ::gelenk::testing::WalkingBvh(5)), std::nullopt);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->skeleton->joint_count(),
            ::gelenk::testing::kWalkingJointCount);
  ASSERT_TRUE(file->clip.has_value());
  EXPECT_EQ(file->clip->frame_count(), 5);
  EXPECT_EQ(file->clip->import.unit_m, 0.01);
  EXPECT_EQ(file->message.display_name(), "walk.bvh");
}

TEST_F(FilesTest, ABvhComesRoundThroughItsPoses) {
  const std::string path = Write("walk.bvh", ::gelenk::testing::WalkingBvh(20));
  const auto clip = ReadBvhClip(path, std::nullopt);
  ASSERT_TRUE(clip.ok()) << clip.status();
  ASSERT_TRUE(WriteBvhClip(*clip, clip->poses, Path("again.bvh")).ok());
  const auto again = ReadBvhClip(Path("again.bvh"), std::nullopt);
  ASSERT_TRUE(again.ok()) << again.status();
  // Degrees and radians, back and forth.
  EXPECT_LT((again->poses - clip->poses).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(again->document.frame_time_s, clip->document.frame_time_s);
}

TEST_F(FilesTest, ABrokenBvhIsToldByLineAndColumn) {
  std::string text = ::gelenk::testing::WalkingBvh(2);
  text.replace(text.find("OFFSET 0 0 0"), 12, "OFFSET 0 x 0");
  const auto file = ReadSkeletonFile(Write("broken.bvh", text), std::nullopt);
  EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(file.status().message()),
              HasSubstr("broken.bvh\": line 4, column 10"));
}

TEST_F(FilesTest, ASkeletonComesRoundThroughJson) {
  const auto bvh = ReadSkeletonFile(
      Write("walk.bvh", ::gelenk::testing::WalkingBvh(2)), std::nullopt);
  ASSERT_TRUE(bvh.ok()) << bvh.status();
  const auto json = ReadSkeletonFile(
      Write("body.json", convert::SkeletonToJson(bvh->message)), std::nullopt);
  ASSERT_TRUE(json.ok()) << json.status();
  EXPECT_EQ(json->message.SerializeAsString(),
            bvh->message.SerializeAsString());
  EXPECT_FALSE(json->clip.has_value());
}

TEST_F(FilesTest, ABadSkeletonIsToldByItsField) {
  const auto file = ReadSkeletonFile(
      Write("bad.json",
            R"({"joints": [{"jointId": "a", "type": "JOINT_TYPE_REVOLUTE"}]})"),
      std::nullopt);
  EXPECT_THAT(std::string(file.status().message()),
              HasSubstr("bad.json\": joints[0].axis"));
  const auto unknown =
      ReadSkeletonFile(Write("unknown.json", R"({"foo": 1})"), std::nullopt);
  EXPECT_THAT(std::string(unknown.status().message()), HasSubstr("foo"));
}

TEST_F(FilesTest, OtherKindsOfFilesAreRefused) {
  const auto file = ReadSkeletonFile("model.fbx", std::nullopt);
  EXPECT_EQ(std::string(file.status().message()),
            "\"model.fbx\": want a .bvh, .asf, .urdf, .gltf, .glb, .vrm or "
            ".json file");
}

TEST_F(FilesTest, ReadsARobot) {
  const auto file = ReadSkeletonFile(
      Write("arm.URDF", ::gelenk::testing::GripperArmUrdf()), std::nullopt);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->skeleton->joint_count(),
            ::gelenk::testing::kGripperArmJointCount);
  EXPECT_EQ(file->message.display_name(), "arm.URDF");
  EXPECT_EQ(file->message.warnings_size(), 2);
  EXPECT_FALSE(file->clip.has_value());
}

TEST_F(FilesTest, ARobotComesRoundThroughJson) {
  const auto urdf = ReadSkeletonFile(
      Write("arm.urdf", ::gelenk::testing::GripperArmUrdf()), std::nullopt);
  ASSERT_TRUE(urdf.ok()) << urdf.status();
  const auto json = ReadSkeletonFile(
      Write("arm.json", convert::SkeletonToJson(urdf->message)), std::nullopt);
  ASSERT_TRUE(json.ok()) << json.status();
  EXPECT_EQ(json->message.SerializeAsString(),
            urdf->message.SerializeAsString());
}

TEST_F(FilesTest, ABrokenRobotIsToldByLine) {
  std::string text = ::gelenk::testing::GripperArmUrdf();
  text.replace(text.find("lower=\"0.1\""), 11, "lower=\"abc\"");
  const auto file = ReadSkeletonFile(Write("broken.urdf", text), std::nullopt);
  EXPECT_THAT(std::string(file.status().message()),
              HasSubstr("broken.urdf\": line 37: <limit lower=\"abc\"> of "
                        "joint \"elbow\": not a number"));
}

TEST_F(FilesTest, ReadsModelsInBothForms) {
  const std::string text = ::gelenk::testing::BodyGltf();
  for (const std::string& path :
       {Write("body.gltf", text),
        Write("body.glb", ::gelenk::testing::Glb(text))}) {
    const auto file = ReadSkeletonFile(path, std::nullopt);
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->skeleton->joint_count(),
              ::gelenk::testing::kBodyGltfJointCount);
    EXPECT_TRUE(ReadSkeletonFile(path, std::nullopt, "Body").ok());
    EXPECT_THAT(
        std::string(
            ReadSkeletonFile(path, std::nullopt, "Tail").status().message()),
        HasSubstr("there is none called \"Tail\""));
    const auto half = ReadSkeletonFile(path, 0.5);
    ASSERT_TRUE(half.ok()) << half.status();
    EXPECT_NEAR(half->skeleton->rest_positions()[1], 0.475, 1e-12);
  }
}

TEST_F(FilesTest, OptionsThatDoNotFitTheFormatAreRefused) {
  const std::string path =
      Write("arm.urdf", ::gelenk::testing::GripperArmUrdf());
  EXPECT_THAT(std::string(ReadSkeletonFile(path, 0.01).status().message()),
              HasSubstr("--unit: a URDF is in metres"));
  EXPECT_THAT(
      std::string(
          ReadSkeletonFile(path, std::nullopt, "Body").status().message()),
      HasSubstr("--skin: only glTF files have skins"));
}

TEST_F(FilesTest, InspectionTellsWhatARobotCanDo) {
  const auto file = ReadSkeletonFile(
      Write("arm.urdf", ::gelenk::testing::GripperArmUrdf()), std::nullopt);
  ASSERT_TRUE(file.ok()) << file.status();
  const Json json = InspectionJson(Inspect(*file));
  EXPECT_THAT(json["tips"], ElementsAre("tip_1", "tip_3", "tip_2"));
  const Json& elbow = json["joints"][4];
  EXPECT_EQ(elbow["id"], "elbow");
  EXPECT_THAT(elbow["lower"], ElementsAre(0.1));
  EXPECT_THAT(elbow["upper"], ElementsAre(2.6));
  EXPECT_THAT(elbow["max_velocity"], ElementsAre(3));
  EXPECT_TRUE(elbow["mimic"].is_null());
  const Json& right = json["joints"][8];
  EXPECT_EQ(right["mimic"]["joint"], "finger");
  EXPECT_EQ(right["mimic"]["multiplier"], 0.5);

  const std::string text = InspectionText(Inspect(*file));
  EXPECT_THAT(text, HasSubstr("tips           tip_1, tip_3, tip_2\n"));
  EXPECT_THAT(text, HasSubstr("0.1 to 2.6 rad, 3 rad/s"));
  EXPECT_THAT(text, HasSubstr("any, 2 rad/s"));
  EXPECT_THAT(text, HasSubstr("0 to 0.04 m, 0.1 m/s"));
  EXPECT_THAT(text, HasSubstr("= 0.5 * finger + 0.009"));
  EXPECT_THAT(text, HasSubstr("forearm\n"));
  EXPECT_THAT(text, HasSubstr("the rest pose has another value"));
}

TEST_F(FilesTest, InspectionTellsWhatIsInTheFile) {
  const auto file = ReadSkeletonFile(
      Write("walk.bvh", ::gelenk::testing::WalkingBvh(50)), std::nullopt);
  ASSERT_TRUE(file.ok()) << file.status();
  const Json json = InspectionJson(Inspect(*file));
  EXPECT_EQ(json["joint_count"], ::gelenk::testing::kWalkingJointCount);
  EXPECT_EQ(json["end_effectors"].size(),
            size_t{::gelenk::testing::kWalkingEndSiteCount});
  EXPECT_EQ(json["clip"]["frames"], 50);
  EXPECT_EQ(json["clip"]["unit_m"], 0.01);
  EXPECT_TRUE(json["clip"]["first_frame_jump"].is_null());
  EXPECT_EQ(json["body"]["left_hand"], "LeftHand");
  EXPECT_EQ(json["body"]["head"], "Head");
  // Bones from foot to crown.
  EXPECT_NEAR(json["height_m"].get<double>(), 1.642, 1e-3);
  EXPECT_EQ(json["joints"][0]["type"], "free");
  EXPECT_THAT(json["joints"][1]["channels"],
              ElementsAre("Zrotation", "Xrotation", "Yrotation"));
  EXPECT_THAT(json["joints"][0]["offset_m"], ElementsAre(0, 0, 0));

  const std::string text = InspectionText(Inspect(*file));
  EXPECT_THAT(text, HasSubstr("├ LeftUpLeg"));
  EXPECT_THAT(text, HasSubstr("50, 1 s at 50 fps"));
  EXPECT_THAT(text, HasSubstr("hips Hips, left hand LeftHand"));
}

TEST_F(FilesTest, TheTreeOfADeepFileIsPrinted) {
  std::string text = "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 0\n";
  constexpr int kDepth = 200;
  for (int i = 0; i < kDepth; ++i) {
    text += "JOINT j" + std::to_string(i) +
            "\n{\nOFFSET 0 1 0\nCHANNELS 1 Xrotation\n";
  }
  for (int i = 0; i <= kDepth; ++i) text += "}\n";
  const auto file = ReadSkeletonFile(Write("deep.bvh", text), std::nullopt);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(InspectionText(Inspect(*file)), HasSubstr("└ j199"));
}

// The humanoid with names that say nothing, as a VRM of either version.
std::string NamelessVrm(bool is_new) {
  const auto body = MakeHumanoid();
  const auto map = ProposeJointMap(*body);
  nlohmann::json file = {{"asset", {{"version", "2.0"}}},
                         {"scene", 0},
                         {"scenes", {{{"nodes", {0}}}}}};
  std::vector<int> joints;
  for (int i = 0; i < body->joint_count(); ++i) {
    const Joint& joint = body->joint(i);
    Eigen::Vector3d place = joint.parent_from_joint.translation;
    if (i == 0) place += body->rest_positions().head<3>();
    file["nodes"].push_back({{"name", absl::StrCat("n", 7 * i % 23)},
                             {"translation", {place[0], place[1], place[2]}}});
    const int parent = body->FindJoint(joint.parent_id);
    if (parent >= 0) file["nodes"][parent]["children"].push_back(i);
    joints.push_back(i);
  }
  file["skins"] = {{{"joints", joints}}};
  const std::vector<std::pair<std::string, BodyRole>> bones = {
      {"hips", BodyRole::kPelvis},
      {"head", BodyRole::kHead},
      {"leftHand", BodyRole::kLeftHand},
      {"rightFoot", BodyRole::kRightFoot},
      {"leftUpperArm", BodyRole::kLeftUpperArm},
      {"leftLowerArm", BodyRole::kLeftForearm}};
  for (const auto& [bone, role] : bones) {
    const int node = map->joint(role);
    if (is_new) {
      file["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"][bone]["node"] =
          node;
    } else {
      file["extensions"]["VRM"]["humanoid"]["humanBones"].push_back(
          {{"bone", bone}, {"node", node}});
    }
  }
  return file.dump();
}

TEST_F(FilesTest, AVrmIsTakenAtItsWord) {
  for (bool is_new : {false, true}) {
    const absl::StatusOr<BodyFile> body =
        ReadBodyFile(Write("hero.gltf", NamelessVrm(is_new)), std::nullopt);
    ASSERT_TRUE(body.ok()) << body.status();
    const JointMap& map = body->model->map;
    const auto humanoid_map = ProposeJointMap(*MakeHumanoid());
    for (BodyRole role :
         {BodyRole::kPelvis, BodyRole::kLeftHand, BodyRole::kRightFoot}) {
      EXPECT_EQ(map.roles[IndexOf(role)].evidence, RoleEvidence::kOverride);
      EXPECT_EQ(map.joint(role), humanoid_map->joint(role));
    }
    // What the file does not name nobody plays.
    EXPECT_FALSE(map.Has(BodyRole::kRightHand));
    // The user has the last word.
    const JointMapOverride given = {"left_hand", ""};
    const absl::StatusOr<BodyFile> mended =
        ReadBodyFile(Path("hero.gltf"), std::nullopt, {given});
    ASSERT_TRUE(mended.ok()) << mended.status();
    EXPECT_FALSE(mended->model->map.Has(BodyRole::kLeftHand));
  }
}

}  // namespace
}  // namespace gelenk::cli
