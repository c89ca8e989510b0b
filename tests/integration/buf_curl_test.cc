// The contract as a client from elsewhere speaks it: `buf curl`, which knows
// the .proto files and nothing else of the project, sends JSON and prints JSON.
//
// The calls are those of docs/api.md.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/testing/server_process.h"

namespace gelenk {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using testing::ServerProcess;

// No call that passes comes near it.
constexpr int kPatienceSeconds = 60;

struct Ending {
  int exit_code = -1;
  // Standard output; where the call failed, standard error.
  std::string text;
};

class BufCurlTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(BUF)) {
      GTEST_SKIP() << "buf is not installed: npm --prefix tools/node ci "
                      "--ignore-scripts";
    }
    ASSERT_EQ(server_.Start(), absl::OkStatus());
  }

  // `body` holds no single quotes.
  Ending Call(const std::string& method, const std::string& body) {
    const std::string command = absl::StrCat(
        "timeout ", kPatienceSeconds,
        " " BUF " curl --schema " PROTO_FOLDER
        " --protocol grpc --http2-prior-knowledge http://",
        server_.target(), "/gelenk.v1.", method, " -d '", body, "' 2>&1");
    FILE* pipe = popen(command.c_str(), "r");
    Ending ending;
    char buffer[4096];
    for (size_t size = 0;
         (size = std::fread(buffer, 1, sizeof(buffer), pipe)) > 0;) {
      ending.text.append(buffer, size);
    }
    const int status = pclose(pipe);
    ending.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return ending;
  }

  // All messages of a call that succeeds.
  std::vector<json> Answers(const std::string& method,
                            const std::string& body) {
    const Ending ending = Call(method, body);
    EXPECT_EQ(ending.exit_code, 0) << ending.text;
    std::vector<json> answers;
    // Concatenated, each a JSON text of its own.
    size_t begin = 0;
    int depth = 0;
    for (size_t i = 0; i < ending.text.size(); ++i) {
      if (ending.text[i] == '{' && depth++ == 0) begin = i;
      if (ending.text[i] == '}' && --depth == 0) {
        answers.push_back(
            json::parse(ending.text.substr(begin, i + 1 - begin)));
      }
    }
    return answers;
  }
  json Answer(const std::string& method, const std::string& body) {
    const std::vector<json> answers = Answers(method, body);
    EXPECT_EQ(answers.size(), 1);
    return answers.empty() ? json() : answers[0];
  }

  void CreateTwoLinks() {
    const json skeleton = Answer("KinematicsService/CreateSkeleton", R"({
      "skeletonId": "two-links",
      "skeleton": {"joints": [
        {"jointId": "shoulder", "type": "JOINT_TYPE_REVOLUTE",
         "axis": {"z": 1}},
        {"jointId": "elbow", "parentJointId": "shoulder",
         "type": "JOINT_TYPE_REVOLUTE", "axis": {"z": 1},
         "parentFromJoint": {"translation": {"x": 1}},
         "limits": {"lower": [0], "upper": [2.5]}}],
       "endEffectors": [
        {"endEffectorId": "hand", "jointId": "elbow",
         "jointFromEndEffector": {"translation": {"x": 1}}}]}})");
    EXPECT_EQ(skeleton["name"], "skeletons/two-links");
    EXPECT_EQ(skeleton["positionCount"], 2);
    EXPECT_EQ(skeleton["velocityCount"], 2);
  }

  ServerProcess server_{GELENKD, {"--log-level", "error"}};
};

TEST_F(BufCurlTest, SolvesOnceAndInASession) {
  CreateTwoLinks();
  const json once = Answer("KinematicsService/SolveInverseKinematics", R"({
      "skeleton": "skeletons/two-links",
      "goals": [{"goalId": "g", "position": {"endEffectorId": "hand",
                 "worldPosition": {"x": 1.2, "y": 0.8}}}]})");
  EXPECT_EQ(once["report"]["outcome"], "OUTCOME_CONVERGED");

  const json session = Answer("SessionService/CreateSession", R"({
      "sessionId": "actor-1",
      "session": {"skeleton": "skeletons/two-links",
        "goals": [{"goalId": "hand",
                   "position": {"endEffectorId": "hand",
                                "worldPosition": {"x": 0.5, "y": 1}}}]}})");
  EXPECT_EQ(session["name"], "sessions/actor-1");
  EXPECT_EQ(session["state"], "STATE_ACTIVE");
  const json solved =
      Answer("SessionService/SolveSession", R"({"name": "sessions/actor-1"})");
  EXPECT_EQ(solved["report"]["outcome"], "OUTCOME_CONVERGED");
  const double shoulder = solved["pose"]["positions"][0];
  const double elbow = solved["pose"]["positions"][1];
  // The default tolerance.
  EXPECT_NEAR(std::cos(shoulder) + std::cos(shoulder + elbow), 0.5, 1e-4);
  EXPECT_NEAR(std::sin(shoulder) + std::sin(shoulder + elbow), 1, 1e-4);
  EXPECT_GE(elbow, 0);
}

TEST_F(BufCurlTest, StreamsFrames) {
  CreateTwoLinks();
  Answer("SessionService/CreateSession", R"({
      "sessionId": "actor-1",
      "session": {"skeleton": "skeletons/two-links",
        "goals": [{"goalId": "hand",
                   "position": {"endEffectorId": "hand"}}]}})");
  std::vector<json> events;
  std::vector<json> frames;
  for (const json& answer : Answers("SessionService/StreamingSolve", R"(
      {"attach": [{"session": "sessions/actor-1",
                   "framePolicy": "FRAME_POLICY_EVERY_FRAME"}]}
      {"frames": [
        {"sequenceNumber": 1, "targets": [{"worldPosition":
                                           {"x": 1.2, "y": 0.8}}]},
        {"sequenceNumber": 2, "targets": [{"worldPosition":
                                           {"x": "NaN"}}]},
        {"sequenceNumber": 3, "targets": [{"worldPosition":
                                           {"x": 1.3, "y": 0.8}}]}]})")) {
    for (const json& event : answer.value("events", json::array())) {
      events.push_back(event);
    }
    for (const json& frame : answer.value("frames", json::array())) {
      frames.push_back(frame);
    }
  }
  ASSERT_EQ(events.size(), 1);
  EXPECT_EQ(events[0]["kind"], "KIND_ATTACHED");
  ASSERT_EQ(frames.size(), 3);
  EXPECT_EQ(frames[0]["report"]["outcome"], "OUTCOME_CONVERGED");
  EXPECT_EQ(frames[1]["sequenceNumber"], "2");
  EXPECT_EQ(frames[1]["status"]["code"], 3);
  EXPECT_EQ(frames[1]["status"]["message"],
            "targets[0].world_position: want finite numbers, got (nan, 0, 0)");
  EXPECT_EQ(frames[1]["pose"], frames[0]["pose"]);
  EXPECT_EQ(frames[2]["report"]["outcome"], "OUTCOME_CONVERGED");
}

TEST_F(BufCurlTest, ErrorsHaveTheDetailsThatEverybodyKnows) {
  const Ending ending = Call("KinematicsService/CreateSkeleton", R"({
      "skeletonId": "Two Links",
      "skeleton": {"joints": [
        {"jointId": "elbow", "type": "JOINT_TYPE_REVOLUTE", "axis": {"z": 1},
         "limits": {"lower": [3], "upper": [2.5]}}]}})");
  EXPECT_NE(ending.exit_code, 0);
  const json error = json::parse(ending.text, nullptr, false);
  ASSERT_TRUE(error.is_object()) << ending.text;
  EXPECT_EQ(error["code"], "invalid_argument");
  EXPECT_THAT(error["message"].get<std::string>(),
              HasSubstr("lower limit 3 > upper limit 2.5"));
  ASSERT_EQ(error["details"].size(), 1) << ending.text;
  EXPECT_EQ(error["details"][0]["type"], "google.rpc.BadRequest");
  EXPECT_FALSE(error["details"][0]["value"].get<std::string>().empty());
}

TEST_F(BufCurlTest, WhatIsNotThereIsNotFound) {
  const Ending ending =
      Call("SessionService/GetSession", R"({"name": "sessions/nobody"})");
  const json error = json::parse(ending.text, nullptr, false);
  ASSERT_TRUE(error.is_object()) << ending.text;
  EXPECT_EQ(error["code"], "not_found");
}

}  // namespace
}  // namespace gelenk
