// The real `gelenk`, with a service of its own and against a real gelenkd.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "convert/skeleton.h"
#include "gelenk/client/connection.h"
#include "gelenk/formats/bvh_reader.h"
#include "tests/integration/command_test.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/gltf_files.h"
#include "tests/testing/gripper_arm_urdf.h"

namespace gelenk {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

INSTANTIATE_TEST_SUITE_P(Hosts, ServedCommandTest,
                         ::testing::Values(Host::kInProcess, Host::kServer),
                         HostName);

TEST_P(ServedCommandTest, ExamplesAreThoseOfTheBooks) {
  const Ending ending = Run({"examples", "--out", "."});
  EXPECT_EQ(ending.exit_code, 0) << ending.err;
  // The closed forms, J, its pseudo-inverse, an iterate, both ends.
  for (const char* number :
       {"8.92820", "1.46410", "-60.000000 deg", "120.000000 deg",
        "-362.943782580", "180.121434603", "0.001024974020", "0.295302848",
        "0.447025350", "0.717900872", "-0.625021896", "0.329549507",
        "0.453006428", "0.712565138", "-0.635649229", "0.329191330",
        "1.41421356237"}) {
    EXPECT_THAT(ending.out, HasSubstr(number));
  }
  EXPECT_THAT(Read(folder_ / "newton_1d.svg"), HasSubstr("</svg>"));
}

TEST_F(CommandLineTest, TheLegExampleSlidesByKeysAlone) {
  const Ending ending = Run({"examples", "leg"});
  EXPECT_EQ(ending.exit_code, 0) << ending.err;
  EXPECT_THAT(ending.out, AllOf(HasSubstr("slide"), HasSubstr("sinks")));
  for (const char* name : {"leg_naive.svg", "leg_contacts.svg"}) {
    EXPECT_THAT(Read(folder_ / name), HasSubstr("</svg>")) << name;
  }
  EXPECT_NE(Run({"examples", "leg", "--out", "nowhere"}).exit_code, 0);
}

TEST_F(CommandLineTest, MotionIsDrawnWithItsContacts) {
  const json made = RunJson({"retarget", "walk.bvh", "--onto", "humanoid",
                             "--out", "out.bvh", "--picture", "both.svg"});
  EXPECT_EQ(made["written"], json({"out.bvh", "both.svg"}));
  EXPECT_THAT(Read(folder_ / "both.svg"), HasSubstr("</svg>"));
  EXPECT_EQ(
      Run({"clip", "measure", "walk.bvh", "--picture", "walk.svg"}).exit_code,
      0);
  EXPECT_THAT(Read(folder_ / "walk.svg"), HasSubstr("class=\"figure\""));
}

TEST_P(ServedCommandTest, DhTables) {
  v1::Skeleton arm;
  convert::ToProto(*gelenk::testing::PandaArm(), &arm);
  Write("arm.json", convert::SkeletonToJson(arm));
  const json table =
      RunJson({"dh", "arm.json", "--tip", "tip", "--convention", "modified"});
  ASSERT_THAT(table["rows"], SizeIs(7));
  EXPECT_NEAR(std::abs(table["rows"][3]["a_m"].get<double>()), 0.0825, 1e-12);
  EXPECT_NEAR(std::abs(table["rows"][2]["d_m"].get<double>()), 0.316, 1e-12);
  const Ending bad = Run({"dh", "arm.json", "--tip", "nose"});
  EXPECT_NE(bad.exit_code, 0);
  EXPECT_THAT(bad.err, HasSubstr("no end effector or joint \"nose\""));
}

TEST_P(ServedCommandTest, WorkspacesExactAndSampled) {
  Write("chain.json", R"({"planarChain": {"linkLengths": [4, 1, 2]}})");
  const json exact = RunJson(
      {"workspace", "chain.json", "--tip", "tip", "--picture", "ring.svg"});
  EXPECT_EQ(exact["annulus"]["inner_radius_m"], 1);
  EXPECT_EQ(exact["annulus"]["outer_radius_m"], 7);
  EXPECT_EQ(exact["annulus"]["world_normal"], json({0, 0, 1}));
  EXPECT_THAT(Read(folder_ / "ring.svg"), HasSubstr("</svg>"));

  const json map =
      RunJson({"workspace", "chain.json", "--tip", "tip", "--samples", "20000",
               "--out", "cloud.csv", "--picture", "map.svg"})["map"];
  EXPECT_EQ(map["samples"], 20000);
  EXPECT_EQ(map["size"][2], 1);
  EXPECT_THAT(Read(folder_ / "map.svg"), HasSubstr("</svg>"));
  std::istringstream cloud(Read(folder_ / "cloud.csv"));
  std::string line;
  std::getline(cloud, line);
  EXPECT_EQ(line, "x_m,y_m,z_m,reach_count,mean_manipulability");
  int rows = 0;
  const double slack = map["voxel_size_m"];
  while (std::getline(cloud, line)) {
    double x = 0;
    double y = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf", &x, &y), 2);
    EXPECT_GE(std::hypot(x, y), 1 - slack);
    EXPECT_LE(std::hypot(x, y), 7 + slack);
    ++rows;
  }
  EXPECT_EQ(rows, map["reached_voxels"]);

  const Ending bad = Run({"workspace", "chain.json", "--tip", "nose"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr("no end effector or joint \"nose\""));
}

TEST_P(ServedCommandTest, TwoLinksInClosedForm) {
  const json both = RunJson({"two-link", "--lengths", "10,10", "--target",
                             "10,0", "--picture", "links.svg"});
  ASSERT_THAT(both["solutions"], SizeIs(2));
  for (const json& solution : both["solutions"]) {
    const double first = solution["angles_rad"][0];
    const double second = solution["angles_rad"][1];
    EXPECT_NEAR(std::abs(first), M_PI / 3, 1e-12);
    EXPECT_NEAR(second, -2 * first, 1e-12);
  }
  EXPECT_THAT(Read(folder_ / "links.svg"), HasSubstr("</svg>"));
  const json limited = RunJson({"two-link", "--lengths", "10,10", "--target",
                                "10,0", "--limits", "0,3,-3,0"});
  EXPECT_EQ(limited["solutions"][limited["best"].get<int>()]["within_limits"],
            true);
  EXPECT_GT(limited["solutions"][limited["best"].get<int>()]["angles_rad"][0],
            0);
  const json leg =
      RunJson({"two-bone", "--root", "0,1,0", "--mid", "0,0.5,0.05", "--tip",
               "0,0,0", "--target", "0,0.2,0.3", "--pole", "0,0.5,1"});
  EXPECT_EQ(leg["unreachable"], false);
  const json& knee = leg["solutions"][leg["best"].get<int>()]["world_mid_m"];
  // The bones keep their lengths, and the knee is on the pole's side.
  EXPECT_NEAR(std::hypot(knee[1].get<double>() - 1, knee[2].get<double>()),
              std::hypot(0.5, 0.05), 1e-12);
  EXPECT_GT(knee[2].get<double>(), 0);

  const Ending bad = Run({"two-link", "--lengths", "10,-1", "--target", "1,0"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr("planar.lower_length_m"));
  EXPECT_EQ(Run({"two-link", "--lengths", "10", "--target", "1,0"}).exit_code,
            2);
}

TEST_P(ServedCommandTest, AnyGoalAsJson) {
  Write("chain.json", R"({"planarChain": {"linkLengths": [1, 1, 1]}})");
  Write("request.json", R"({"goals": [
    {"goalId": "reach", "position": {"endEffectorId": "tip",
     "worldPosition": {"x": 1.5, "y": 1}, "axes": {"x": true, "y": true}}},
    {"goalId": "rest", "weight": 1e-6, "posture": {"pose":
     {"positions": [0.5, 0.5, 0.5]}}}]})");
  const json solved = RunJson({"ik", "chain.json", "--request", "request.json",
                               "--picture", "pose.svg"});
  EXPECT_EQ(solved["outcome"], "converged") << solved;
  EXPECT_EQ(solved["goals"][0]["kind"], "position");
  EXPECT_EQ(solved["goals"][0]["end_effector"], "tip");
  EXPECT_EQ(solved["goals"][1]["kind"], "posture");
  EXPECT_EQ(solved["goals"][1]["end_effector"], "rest");
  EXPECT_THAT(Read(folder_ / "pose.svg"), HasSubstr("</svg>"));
  Write("bad.json", R"({"goals": [{"x": 1}]})");
  const Ending bad = Run({"ik", "chain.json", "--request", "bad.json"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr("goals[0]"));
}

TEST_P(ServedCommandTest, PlayReachesEveryFrameInsideTheLimits) {
  const json report = RunJson(
      {"play", "walk.bvh", "--out", "solved.bvh", "--picture", "solved.svg"});
  EXPECT_EQ(report["answered"], kFrames);
  EXPECT_EQ(report["outcomes"]["converged"], kFrames);
  EXPECT_EQ(report["limits_kept"], true);
  EXPECT_LT(report["position_residual_mm"]["max"].get<double>(), 1.0);
  EXPECT_LT(report["residual_disagreement_m"].get<double>(), 1e-6);
  EXPECT_THAT(report["written"], ElementsAre("solved.bvh", "solved.svg"));

  const auto clip = ReadBvh(Read(folder_ / "walk.bvh"));
  const auto solved = ReadBvh(Read(folder_ / "solved.bvh"));
  ASSERT_TRUE(solved.ok()) << solved.status();
  EXPECT_EQ(solved->frame_count(), kFrames);
  EXPECT_EQ(solved->channel_count(), clip->channel_count());
  EXPECT_EQ(solved->frame_time_text, clip->frame_time_text);
  EXPECT_THAT(Read(folder_ / "solved.svg"), StartsWith("<svg "));
}

TEST_P(ServedCommandTest, PlayTakesItsOptions) {
  const json report = RunJson(
      {"play", "walk.bvh", "--limits", "none", "--policy", "latest", "--batch",
       "1", "--fps", "400", "--tolerance", "5e-3,5e-2", "--picture", "a.html"});
  EXPECT_GT(report["answered"], 0);
  EXPECT_EQ(report["refused"], 0);
  EXPECT_EQ(report["limits"], "none");
  EXPECT_EQ(report["position_tolerance_m"], 5e-3);
  EXPECT_EQ(report["rotation_tolerance_rad"], 5e-2);
  EXPECT_LT(report["played_fps"].get<double>(), 420);
  EXPECT_THAT(Read(folder_ / "a.html"), StartsWith("<!DOCTYPE html>"));
}

TEST_P(ServedCommandTest, TheTableNamesWhatWasPlayed) {
  const Ending ending = Run({"play", "walk.bvh"});
  EXPECT_EQ(ending.exit_code, 0) << ending.err;
  EXPECT_THAT(ending.out,
              AllOf(HasSubstr("walk.bvh, 80 frames, 1.6 s at 50 fps"),
                    HasSubstr("100 % converged (80 of 80)"),
                    HasSubstr("every answer inside")));
  // No progress bar without a terminal.
  EXPECT_THAT(ending.err, IsEmpty());
}

TEST_P(ServedCommandTest, AnIkSolutionIsWhereItWasWanted) {
  const json solution = RunJson(
      {"ik", "walk.bvh", "--goal", "LeftHand=0.5,1.2,0.3", "--rotation-goal",
       "Head=0,0.1,0,0.995", "--diagnose", "--tolerance", "1e-5,1e-4"});
  EXPECT_EQ(solution["outcome"], "converged");
  EXPECT_EQ(solution["goals"][1]["kind"], "rotation");
  EXPECT_GT(solution["rank"], 0);

  std::string pose;
  for (const json& number : solution["positions"]) pose += number.dump() + "\n";
  Write("pose.txt", pose);
  const json frames = RunJson({"fk", "walk.bvh", "--pose-file", "pose.txt"});
  for (const json& joint : frames["joints"]) {
    if (joint["id"] != "LeftHand") continue;
    EXPECT_NEAR(joint["world_translation_m"][0], 0.5, 2e-5);
    EXPECT_NEAR(joint["world_translation_m"][1], 1.2, 2e-5);
    EXPECT_NEAR(joint["world_translation_m"][2], 0.3, 2e-5);
  }
}

TEST_P(ServedCommandTest, FkFollowsTheClip) {
  const json frames = RunJson({"fk", "walk.bvh", "--frame", "50"});
  ASSERT_THAT(frames["joints"], SizeIs(gelenk::testing::kWalkingJointCount));
  // 1.1 m/s for a second.
  EXPECT_NEAR(frames["joints"][0]["world_translation_m"][2], 1.1, 1e-6);
  EXPECT_THAT(Run({"fk", "walk.bvh"}).out, HasSubstr("QW"));
}

TEST_P(ServedCommandTest, ASavedSkeletonIsAsGoodAsTheClip) {
  EXPECT_EQ(Run({"info", "walk.bvh", "--save", "body.json"}).exit_code, 0);
  EXPECT_EQ(RunJson({"info", "body.json"})["joint_count"],
            gelenk::testing::kWalkingJointCount);
  const std::vector<std::string> goal = {"--goal", "LeftHand=0.5,1.2,0.3"};
  EXPECT_EQ(RunJson({"ik", "body.json", goal[0], goal[1]})["positions"],
            RunJson({"ik", "walk.bvh", goal[0], goal[1]})["positions"]);
}

TEST_P(ServedCommandTest, ARobotReachesWithALink) {
  Write("arm.urdf", gelenk::testing::GripperArmUrdf());
  const Ending info = Run({"info", "arm.urdf", "--save", "arm.json"});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("0.1 to 2.6 rad, 3 rad/s"));
  const std::vector<std::string> goal = {"--goal", "palm=0.4,0.3,0.5"};
  const json solution = RunJson({"ik", "arm.urdf", goal[0], goal[1]});
  EXPECT_EQ(solution["outcome"], "converged");
  EXPECT_EQ(RunJson({"ik", "arm.json", goal[0], goal[1]})["positions"],
            solution["positions"]);
  EXPECT_THAT(RunJson({"fk", "arm.urdf"})["joints"],
              SizeIs(gelenk::testing::kGripperArmJointCount));
}

TEST_P(ServedCommandTest, AModelReachesWithItsHand) {
  Write("body.glb", gelenk::testing::Glb(gelenk::testing::BodyGltf()));
  EXPECT_EQ(RunJson({"info", "body.glb", "--skin", "Body"})["joint_count"],
            gelenk::testing::kBodyGltfJointCount);
  EXPECT_EQ(
      RunJson({"ik", "body.glb", "--goal", "LeftHand=0.8,1.2,0.3"})["outcome"],
      "converged");
}

TEST_P(ServedCommandTest, UnknownGoalsAreNamed) {
  const Ending ending = Run({"ik", "walk.bvh", "--goal", "Nose=0,1,0"});
  EXPECT_EQ(ending.exit_code, 1);
  EXPECT_THAT(ending.err,
              AllOf(StartsWith("gelenk: goals[0]"), HasSubstr("\"Nose\"")));
}

TEST_P(ServedCommandTest, PosesOfTheWrongSizeAreRefused) {
  const Ending ending = Run({"fk", "walk.bvh", "--pose", "1,2,3"});
  EXPECT_EQ(ending.exit_code, 1);
  EXPECT_THAT(ending.err, HasSubstr("got 3"));
}

TEST_F(CommandLineTest, ARetargetedWalkIsMeasured) {
  const json made =
      RunJson({"retarget", "walk.bvh", "--onto", "humanoid", "--out", "a.bvh"});
  EXPECT_EQ(made["frames"], kFrames);
  EXPECT_LE(made["penetration_max_m"].get<double>(), 1e-3);
  EXPECT_EQ(made["beside_source"]["new_hyper_extended_frames"], 0);
  const auto written = ReadBvh(Read(folder_ / "a.bvh"));
  ASSERT_TRUE(written.ok()) << written.status();
  EXPECT_EQ(written->frame_count(), kFrames);
  // The file measures like what it was written from.
  const json measured =
      RunJson({"clip", "measure", "a.bvh", "--reference", "walk.bvh"});
  EXPECT_NEAR(measured["skate_cm_s"].get<double>(),
              made["skate_cm_s"].get<double>(), 0.5);
  EXPECT_EQ(Run({"retarget", "walk.bvh", "--onto", "humanoid", "--out", "a.glb",
                 "--live"})
                .exit_code,
            0);
  EXPECT_THAT(Read(folder_ / "a.glb"), StartsWith("glTF"));
}

// What a running server makes of clips is what the command makes of them.
TEST_F(CommandLineTest, AServerDoesTheSameToClips) {
  gelenk::testing::ServerProcess gelenkd(GELENKD);
  ASSERT_EQ(gelenkd.Start(), absl::OkStatus());
  Write("t_pose.bvh", gelenk::testing::WalkingBvhBehindATPose(kFrames));
  const std::vector<std::vector<std::string>> commands = {
      {"clip", "smooth", "t_pose.bvh", "--cutoff", "5"},
      {"clip", "mirror", "walk.bvh"},
      {"clip", "plant", "walk.bvh"},
      {"clip", "crop", "walk.bvh", "--start", "0.2", "--end", "0.4"},
      {"clip", "resample", "walk.bvh", "--rate", "25"},
      {"clip", "convert", "walk.bvh"},
      {"retarget", "walk.bvh", "--onto", "humanoid"},
      {"retarget", "walk.bvh", "--onto", "t_pose.bvh"}};
  for (std::vector<std::string> command : commands) {
    SCOPED_TRACE(command[1]);
    std::vector<std::string> outputs;
    std::vector<std::string> files;
    for (const bool is_served : {false, true}) {
      server_ = is_served ? gelenkd.target() : "";
      fs::remove(folder_ / "out.bvh");
      std::vector<std::string> arguments = command;
      arguments.insert(arguments.end(), {"--out", "out.bvh"});
      const Ending ending = Run(arguments);
      EXPECT_EQ(ending.exit_code, 0) << ending.err;
      outputs.push_back(ending.out);
      files.push_back(Read(folder_ / "out.bvh"));
    }
    EXPECT_EQ(outputs[0], outputs[1]);
    EXPECT_EQ(files[0], files[1]);
    EXPECT_THAT(files[0], StartsWith("HIERARCHY"));
  }
  std::vector<std::string> measures;
  for (const bool is_served : {false, true}) {
    server_ = is_served ? gelenkd.target() : "";
    measures.push_back(
        Run({"clip", "measure", "out.bvh", "--reference", "walk.bvh"}).out);
  }
  EXPECT_EQ(measures[0], measures[1]);
  EXPECT_THAT(measures[0], HasSubstr("skate of planted points"));
  // Nothing stays there.
  client::Connection connection(gelenkd.target());
  EXPECT_EQ(
      connection
          .Call(&v1::MotionService::Stub::ListClips, v1::ListClipsRequest())
          ->clips_size(),
      0);
  EXPECT_EQ(connection
                .Call(&v1::KinematicsService::Stub::ListSkeletons,
                      v1::ListSkeletonsRequest())
                ->skeletons_size(),
            0);
  const Ending bad =
      Run({"clip", "crop", "walk.bvh", "--start", "9", "--out", "out.bvh"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, AllOf(HasSubstr("\"walk.bvh\""), HasSubstr("start_s")));
}

TEST_F(CommandLineTest, CommandsOnFilesRefuseAServer) {
  server_ = "127.0.0.1:1";
  const std::vector<std::vector<std::string>> commands = {
      {"clip", "info", "walk.bvh"},
      {"clip", "blend", "walk.bvh", "walk.bvh", "--out", "out.bvh"},
      {"clip", "measure", "walk.bvh", "--picture", "out.svg"},
      {"map", "walk.bvh"}};
  for (const std::vector<std::string>& command : commands) {
    const Ending ending = Run(command);
    EXPECT_EQ(ending.exit_code, 2) << command[1];
    EXPECT_THAT(ending.err, AnyOf(HasSubstr("excludes --server"),
                                  HasSubstr("--server excludes --picture")));
  }
}

TEST_F(CommandLineTest, MapsAreProposedAndOverridden) {
  const json map = RunJson({"map", "walk.bvh", "humanoid"});
  std::map<std::string, std::string> joints;
  for (const json& entry : map["source"])
    joints[entry["role"]] = entry["joint"];
  EXPECT_EQ(joints["left_foot"], "LeftFoot");
  EXPECT_EQ(joints["head"], "Head");
  EXPECT_THAT(map["target"], Not(IsEmpty()));
  Write("bad.json", R"({"source": [{"role": "tail", "joint": "Hips"}]})");
  const Ending bad = Run({"retarget", "walk.bvh", "--onto", "humanoid", "--out",
                          "a.bvh", "--map", "bad.json"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr("tail"));
  EXPECT_FALSE(fs::exists(folder_ / "a.bvh"));
}

TEST_F(CommandLineTest, ClipsAreSmoothedMirroredAndConverted) {
  for (const char* step : {"smooth", "mirror"}) {
    ASSERT_EQ(Run({"clip", step, "walk.bvh", "--out", "b.bvh"}).exit_code, 0);
    const auto written = ReadBvh(Read(folder_ / "b.bvh"));
    ASSERT_TRUE(written.ok()) << written.status();
    EXPECT_EQ(written->frame_count(), kFrames);
  }
  EXPECT_EQ(Run({"clip", "convert", "walk.bvh", "--out", "b.glb"}).exit_code,
            0);
  EXPECT_THAT(Read(folder_ / "b.glb"), StartsWith("glTF"));
  EXPECT_EQ(Run({"clip", "mirror", "b.glb", "--out", "c.bvh"}).exit_code, 0);
  EXPECT_TRUE(ReadBvh(Read(folder_ / "c.bvh")).ok());
  const Ending robot = Run({"clip", "mirror", "arm.urdf", "--out", "c.bvh"});
  EXPECT_EQ(robot.exit_code, 1);
  EXPECT_THAT(robot.err,
              HasSubstr("want a .bvh, .amc, .gltf, .glb or .vrm file"));
  const Ending bad = Run({"clip", "convert", "walk.bvh", "--out", "b.fbx"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr(".glb"));
}

TEST_F(CommandLineTest, ClipsTellWhatIsInThem) {
  const json walk = RunJson({"clip", "info", "walk.bvh"});
  EXPECT_EQ(walk["frames"], kFrames);
  EXPECT_EQ(walk["unit_m"], 0.01);
  EXPECT_GT(walk["root_path_m"].get<double>(), 0);
  ASSERT_EQ(Run({"clip", "convert", "walk.bvh", "--out", "d.glb"}).exit_code,
            0);
  const json model = RunJson({"clip", "info", "d.glb"});
  EXPECT_EQ(model["animations"].size(), 1u);
  EXPECT_NEAR(model["duration_s"].get<double>(),
              walk["duration_s"].get<double>(), 1e-6);
  EXPECT_THAT(Run({"clip", "info", "walk.bvh"}).out,
              HasSubstr("way of the root"));
  const Ending bad = Run({"clip", "info", "d.glb", "--animation", "1"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr("--animation: want 0 to 0 or one of \""));
}

TEST_F(CommandLineTest, AcclaimsFilesBecomeClips) {
  Write("leg.asf",
        ":units\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n"
        ":bonedata\n begin\n name thigh\n direction 0 -1 0\n length 40\n"
        " axis 0 0 0 XYZ\n dof rx\n end\n begin\n name shin\n"
        " direction 0 -1 0\n length 40\n end\n"
        ":hierarchy\n begin\n root thigh\n thigh shin\n end\n");
  Write("kick.amc",
        ":DEGREES\n1\nroot 0 80 0 0 0 0\nthigh 0\n2\nroot 0 80 5 0 0 0\n"
        "thigh 30\n");
  EXPECT_THAT(Run({"info", "leg.asf", "--unit", "0.01"}).out,
              AllOf(HasSubstr("thigh"), HasSubstr("shin")));
  const Ending made = Run({"clip", "convert", "kick.amc", "--skeleton",
                           "leg.asf", "--out", "kick.bvh"});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  const auto written = ReadBvh(Read(folder_ / "kick.bvh"));
  ASSERT_TRUE(written.ok()) << written.status();
  EXPECT_EQ(written->frame_count(), 2);
  EXPECT_EQ(written->joints[1].name, "thigh");
  EXPECT_NEAR(written->motion(7, 1), 30, 1e-9);
  Ending bad = Run({"clip", "convert", "kick.amc", "--out", "kick.bvh"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr("--skeleton: want the .asf file"));
  Write("bad.amc", "1\nroot 0 80 0 0 0\n");
  bad = Run({"clip", "info", "bad.amc", "--skeleton", "leg.asf"});
  EXPECT_THAT(bad.err, HasSubstr("\"bad.amc\": line 3, column 1: expected"));
}

TEST_F(CommandLineTest, AnAnimationMovesOtherBodies) {
  ASSERT_EQ(Run({"clip", "convert", "walk.bvh", "--out", "d.glb"}).exit_code,
            0);
  const json model = RunJson({"clip", "info", "d.glb"});
  const std::string name = model["animations"][0];
  const json from_bvh =
      RunJson({"retarget", "walk.bvh", "--onto", "humanoid", "--out", "a.bvh"});
  for (const std::string& animation : {std::string("0"), name}) {
    const json made = RunJson({"retarget", "d.glb", "--onto", "humanoid",
                               "--out", "e.bvh", "--animation", animation});
    EXPECT_EQ(made["frames"], kFrames);
    // The file holds floats.
    EXPECT_NEAR(made["skate_cm_s"].get<double>(),
                from_bvh["skate_cm_s"].get<double>(), 0.1);
    EXPECT_LE(made["penetration_max_m"].get<double>(), 1e-3);
  }
  EXPECT_EQ(Run({"retarget", "d.glb", "--onto", "walk.bvh", "--out", "e.bvh",
                 "--live"})
                .exit_code,
            0);
  // An avatar by its own name.
  fs::copy_file(folder_ / "d.glb", folder_ / "d.vrm");
  EXPECT_EQ(
      Run({"retarget", "d.vrm", "--onto", "d.vrm", "--out", "v.bvh"}).exit_code,
      0);
  const json walk = RunJson({"clip", "measure", "walk.bvh"});
  const json measured = RunJson({"clip", "measure", "d.glb", "--reference",
                                 "walk.bvh", "--animation", name});
  EXPECT_NEAR(measured["jerk_m_s3"].get<double>(),
              walk["jerk_m_s3"].get<double>(),
              0.01 * walk["jerk_m_s3"].get<double>());
  const Ending bad = Run({"retarget", "d.glb", "--onto", "humanoid", "--out",
                          "f.bvh", "--animation", "run"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr("got \"run\""));
  EXPECT_FALSE(fs::exists(folder_ / "f.bvh"));
  Write("still.gltf", gelenk::testing::BodyGltf());
  EXPECT_EQ(Run({"clip", "measure", "still.gltf"}).exit_code, 1);
}

TEST_F(CommandLineTest, ClipsAreCutPlantedAndBlended) {
  const auto frames_of = [this](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "clip");
    arguments.insert(arguments.end(), {"--out", "g.bvh"});
    const Ending ending = Run(arguments);
    EXPECT_EQ(ending.exit_code, 0) << ending.err;
    const auto written = ReadBvh(Read(folder_ / "g.bvh"));
    return written.ok() ? written->frame_count() : -1;
  };
  EXPECT_EQ(frames_of({"plant", "walk.bvh"}), kFrames);
  EXPECT_EQ(frames_of({"crop", "walk.bvh", "--start", "0.2", "--end", "0.4"}),
            11);
  EXPECT_EQ(frames_of({"resample", "walk.bvh", "--rate", "25"}),
            (kFrames + 1) / 2);
  ASSERT_EQ(Run({"clip", "mirror", "walk.bvh", "--out", "m.bvh"}).exit_code, 0);
  EXPECT_EQ(frames_of({"blend", "walk.bvh", "m.bvh"}), kFrames);
  EXPECT_EQ(frames_of({"blend", "walk.bvh", "m.bvh", "--below", "LeftArm",
                       "--part", "1"}),
            kFrames);
  EXPECT_EQ(frames_of({"blend", "walk.bvh", "m.bvh", "--beyond", "walk.bvh"}),
            kFrames);
  EXPECT_GT(
      frames_of({"blend", "walk.bvh", "m.bvh", "--at", "0.3", "--fade", "0.2"}),
      kFrames);
  Ending bad = Run({"clip", "blend", "walk.bvh", "m.bvh", "--below", "Tail",
                    "--out", "h.bvh"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr("--below: no joint \"Tail\""));
  EXPECT_FALSE(fs::exists(folder_ / "h.bvh"));
  ASSERT_EQ(
      Run({"retarget", "walk.bvh", "--onto", "humanoid", "--out", "other.bvh"})
          .exit_code,
      0);
  bad = Run({"clip", "blend", "walk.bvh", "other.bvh", "--out", "h.bvh"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr("retarget it first"));
}

TEST_F(CommandLineTest, BadFilesAreToldByPlace) {
  Ending ending = Run({"play", "missing.bvh"});
  EXPECT_EQ(ending.exit_code, 1);
  EXPECT_THAT(ending.err, HasSubstr("\"missing.bvh\""));
  EXPECT_THAT(ending.out, IsEmpty());

  std::string text = gelenk::testing::WalkingBvh(2);
  text.replace(text.find("OFFSET 0 0 0"), 12, "OFFSET 0 x 0");
  Write("broken.bvh", text);
  ending = Run({"info", "broken.bvh"});
  EXPECT_EQ(ending.exit_code, 1);
  EXPECT_THAT(ending.err, HasSubstr("line 4, column 10"));

  Write("still.bvh", gelenk::testing::WalkingBvh(0));
  ending = Run({"play", "still.bvh"});
  EXPECT_EQ(ending.exit_code, 1);
  EXPECT_THAT(ending.err, HasSubstr("no frames to play"));

  ending = Run({"play", "walk.bvh", "--out", "no/such/folder.bvh"});
  EXPECT_EQ(ending.exit_code, 1);
  EXPECT_THAT(ending.err, HasSubstr("no/such/folder.bvh"));
}

TEST_F(CommandLineTest, MistakesOnTheCommandLineEndWithTwo) {
  const std::vector<std::vector<std::string>> mistakes = {
      {"dance"},
      {"play"},
      {"play", "walk.bvh", "--speed", "2"},
      {"play", "walk.bvh", "--policy", "some"},
      {"play", "walk.bvh", "--batch", "0"},
      {"play", "walk.bvh", "--fps", "-1"},
      {"play", "walk.bvh", "--tolerance", "0"},
      {"ik", "walk.bvh"},
      {"ik", "walk.bvh", "--goal", "Head=1,2"},
      {"ik", "walk.bvh", "--goal", "Head=1,2,3", "--start", "a"},
      {"fk", "walk.bvh", "--frame", "1", "--pose", "1"},
      {"info", "walk.bvh", "--format", "yaml"},
      {"sessions"},
  };
  for (const auto& mistake : mistakes) {
    const Ending ending = Run(mistake);
    EXPECT_EQ(ending.exit_code, 2) << absl::StrJoin(mistake, " ");
    EXPECT_THAT(ending.err, StartsWith("gelenk: "));
    EXPECT_EQ(std::count(ending.err.begin(), ending.err.end(), '\n'), 1);
  }
}

TEST_F(CommandLineTest, HelpAndVersionAreNoMistakes) {
  for (const char* command : {"info", "fk", "ik", "play", "sessions"}) {
    const Ending ending = Run({command, "--help"});
    EXPECT_EQ(ending.exit_code, 0);
    EXPECT_THAT(ending.out, HasSubstr(absl::StrCat("gelenk ", command)));
    EXPECT_THAT(ending.out, HasSubstr("Examples:"));
  }
  EXPECT_THAT(Run({"--version"}).out, StartsWith("gelenk "));
}

TEST_F(CommandLineTest, AServerThatIsNotThereIsNamed) {
  server_ = "127.0.0.1:1";
  const Ending ending = Run({"sessions"});
  EXPECT_EQ(ending.exit_code, 1);
  EXPECT_EQ(ending.err, "gelenk: no server answers at 127.0.0.1:1\n");
}

class SessionsCommandTest : public CommandLineTest {
 protected:
  void SetUp() override {
    CommandLineTest::SetUp();
    ASSERT_EQ(gelenkd_.Start(), absl::OkStatus());
    server_ = gelenkd_.target();
  }

  void CreateSession(const std::string& id) {
    client::Connection connection(server_);
    v1::CreateSkeletonRequest skeleton;
    skeleton.set_skeleton_id("panda");
    convert::ToProto(*gelenk::testing::PandaArm(), skeleton.mutable_skeleton());
    ASSERT_TRUE(
        connection.Call(&v1::KinematicsService::Stub::CreateSkeleton, skeleton)
            .ok());
    v1::CreateSessionRequest session;
    session.set_session_id(id);
    session.mutable_session()->set_skeleton("skeletons/panda");
    v1::Goal* goal = session.mutable_session()->add_goals();
    goal->set_goal_id("reach");
    goal->mutable_position()->set_end_effector_id("tip");
    ASSERT_TRUE(
        connection.Call(&v1::SessionService::Stub::CreateSession, session)
            .ok());
  }

  gelenk::testing::ServerProcess gelenkd_{GELENKD};
};

TEST_F(SessionsCommandTest, ListsShowsAndDeletes) {
  EXPECT_THAT(RunJson({"sessions"})["sessions"], IsEmpty());
  CreateSession("robot");
  EXPECT_THAT(Run({"sessions", "list"}).out,
              AllOf(HasSubstr("sessions/robot"), HasSubstr("skeletons/panda"),
                    HasSubstr("active")));
  EXPECT_EQ(RunJson({"sessions"})["sessions"][0]["name"], "sessions/robot");
  EXPECT_THAT(Run({"sessions", "get", "robot"}).out, HasSubstr("reach"));
  EXPECT_EQ(RunJson({"sessions", "get", "sessions/robot"})["skeleton"],
            "skeletons/panda");

  EXPECT_EQ(Run({"sessions", "delete", "robot"}).exit_code, 0);
  EXPECT_THAT(Run({"sessions"}).out, Not(HasSubstr("robot")));
  const Ending gone = Run({"sessions", "get", "robot"});
  EXPECT_EQ(gone.exit_code, 1);
  EXPECT_THAT(gone.err, HasSubstr("robot"));
}

TEST_F(SessionsCommandTest, PlayLeavesNothingBehind) {
  EXPECT_EQ(Run({"play", "walk.bvh"}).exit_code, 0);
  EXPECT_EQ(Run({"fk", "walk.bvh"}).exit_code, 0);
  EXPECT_THAT(RunJson({"sessions"})["sessions"], IsEmpty());
  client::Connection connection(server_);
  const auto skeletons = connection.Call(
      &v1::KinematicsService::Stub::ListSkeletons, v1::ListSkeletonsRequest());
  ASSERT_TRUE(skeletons.ok()) << skeletons.status();
  EXPECT_EQ(skeletons->skeletons_size(), 0);
}

}  // namespace
}  // namespace gelenk
