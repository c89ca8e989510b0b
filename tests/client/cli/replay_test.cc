// Logs of sessions: written, read, and refused by place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "client/cli/file_bytes.h"
#include "client/cli/local_server.h"
#include "client/cli/replay/replayer.h"
#include "client/cli/replay/session_log.h"
#include "client/cli/replay/session_recorder.h"
#include "convert/skeleton.h"
#include "gelenk/client/connection.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/status_matchers.h"

namespace gelenk::cli {
namespace {

using ::gelenk::testing::Fails;
using ::testing::HasSubstr;
constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

v1::TargetFrame FrameTo(int64_t number, double x) {
  v1::TargetFrame frame;
  frame.set_sequence_number(number);
  frame.add_targets()->mutable_world_position()->set_x(x);
  return frame;
}

v1::PoseFrame AnswerOf(int64_t number, double angle) {
  v1::PoseFrame answer;
  answer.set_sequence_number(number);
  answer.mutable_pose()->add_positions(angle);
  answer.mutable_pose()->add_positions(-0.0);
  return answer;
}

class ReplayTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    server_.set_instruction_set("baseline");
    convert::ToProto(*::gelenk::testing::PandaArm(),
                     spec_.skeleton.mutable_skeleton());
    v1::Session* session = spec_.session.mutable_session();
    for (const char* id : {"reach", "stay"}) {
      v1::Goal* goal = session->add_goals();
      goal->set_goal_id(id);
      goal->mutable_position()->set_end_effector_id("tip");
      goal->mutable_position()->mutable_world_position()->set_x(0.4);
      goal->mutable_position()->mutable_world_position()->set_z(0.5);
    }
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // A log of two frames.
  std::string Bytes() {
    auto writer = *SessionLogWriter::Open(path_, server_, spec_);
    EXPECT_EQ(writer->Append(FrameTo(3, 0.1), AnswerOf(3, 0.5)),
              absl::OkStatus());
    EXPECT_EQ(writer->Append(FrameTo(7, 0.2), AnswerOf(7, 0.25)),
              absl::OkStatus());
    EXPECT_EQ(writer->Close(), absl::OkStatus());
    return *ReadFile(path_);
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) /
      ::testing::UnitTest::GetInstance()->current_test_info()->name();
  const std::string path_ = (folder_ / "session.log").string();
  v1::ServerInfo server_;
  client::SessionSpec spec_;
};

TEST_F(ReplayTest, ALogComesRound) {
  const std::string bytes = Bytes();
  const SessionLog log = *ParseSessionLog(bytes);
  EXPECT_EQ(log.server.instruction_set(), "baseline");
  EXPECT_EQ(log.spec.session.session().goals_size(), 2);
  EXPECT_FALSE(log.spec.source_skeleton.has_skeleton());
  ASSERT_EQ(log.frames.frames().size(), 2);
  const auto& second = log.frames.frames()[1];
  EXPECT_EQ(second.sequence_number, 7);
  EXPECT_EQ(second.input.targets(0).world_position().x(), 0.2);
  EXPECT_EQ(second.positions, Eigen::Vector2d(0.25, 0));
}

TEST_F(ReplayTest, CutOffAnywhereItIsRefused) {
  const std::string bytes = Bytes();
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(ParseSessionLog(bytes.substr(0, size)).ok()) << size;
  }
  EXPECT_THAT(ParseSessionLog(bytes.substr(0, bytes.size() - 1)).status(),
              Fails(kInvalid, "frame 2: the file ends here: it was cut off"));
  EXPECT_THAT(ParseSessionLog(bytes.substr(0, bytes.size() - 3)).status(),
              Fails(kInvalid, "answer of frame 1: want"));
}

TEST_F(ReplayTest, WhatIsNoLogIsRefused) {
  const std::string magic(kSessionLogMagic);
  EXPECT_THAT(ParseSessionLog("HIERARCHY\n").status(),
              Fails(kInvalid, "is no log"));
  EXPECT_THAT(ParseSessionLog(magic + std::string(8, '\xff')).status(),
              Fails(kInvalid, absl::StrCat("byte ", magic.size(),
                                           ": server: want a length")));
  EXPECT_THAT(ParseSessionLog(magic + "\x02\xff\xff").status(),
              Fails(kInvalid, "server: is no gelenk.v1.ServerInfo"));
  // Without a skeleton there is nothing to solve.
  EXPECT_THAT(ParseSessionLog(magic + std::string(5, '\0')).status(),
              Fails(kInvalid, "want a skeleton and a session"));
  EXPECT_THAT(ParseSessionLog(Bytes() + "x").status(),
              Fails(kInvalid, "more bytes behind it"));
}

TEST_F(ReplayTest, FramesOutOfOrderAreRefused) {
  auto writer = *SessionLogWriter::Open(path_, server_, spec_);
  ASSERT_TRUE(writer->Append(FrameTo(3, 0), AnswerOf(3, 0)).ok());
  ASSERT_TRUE(writer->Append(FrameTo(3, 0), AnswerOf(3, 0)).ok());
  ASSERT_TRUE(writer->Close().ok());
  EXPECT_THAT(ReadSessionLog(path_).status(),
              Fails(kInvalid, "frame 1: sequence_number: want more than"));
  writer = *SessionLogWriter::Open(path_, server_, spec_);
  ASSERT_TRUE(writer->Append(FrameTo(3, 0), AnswerOf(4, 0)).ok());
  ASSERT_TRUE(writer->Close().ok());
  EXPECT_THAT(ReadSessionLog(path_).status(),
              Fails(kInvalid, "frame 0: the answer is that of"));
}

TEST_F(ReplayTest, AFullLogKeepsWhatItHas) {
  const size_t whole = Bytes().size();
  for (const SessionLogLimits limits :
       {SessionLogLimits{.max_frames = 2}, SessionLogLimits{.max_bytes = whole},
        SessionLogLimits{.max_frames = 1},
        SessionLogLimits{.max_bytes = whole - 1}}) {
    const int room = limits.max_frames == 1 || limits.max_bytes < whole ? 1 : 2;
    auto writer = *SessionLogWriter::Open(path_, server_, spec_, limits);
    EXPECT_TRUE(writer->Append(FrameTo(3, 0.1), AnswerOf(3, 0.5)).ok());
    EXPECT_EQ(writer->Append(FrameTo(7, 0.2), AnswerOf(7, 0.25)).ok(),
              room == 2);
    EXPECT_THAT(
        writer->Append(FrameTo(8, 0.2), AnswerOf(8, 0.25)),
        Fails(absl::StatusCode::kResourceExhausted,
              limits.max_frames < 3
                  ? absl::StrCat("want at most ", room, " frames")
                  : absl::StrCat("want at most ", limits.max_bytes, " bytes")));
    EXPECT_EQ(writer->Close(), absl::OkStatus());
    const auto log = ReadSessionLog(path_);
    ASSERT_TRUE(log.ok()) << log.status();
    EXPECT_EQ(log->frames.frames().size(), room);
  }
}

TEST_F(ReplayTest, ALogBeyondTheLimitsIsRefused) {
  const std::string bytes = Bytes();
  const int size = static_cast<int>(bytes.size());
  EXPECT_TRUE(ParseSessionLog(bytes, {.max_frames = 2}).ok());
  EXPECT_TRUE(ParseSessionLog(bytes, {.max_bytes = bytes.size()}).ok());
  EXPECT_THAT(
      ParseSessionLog(bytes, {.max_frames = 1}).status(),
      Fails(absl::StatusCode::kResourceExhausted, "want at most 1 in a log"));
  EXPECT_THAT(ParseSessionLog(bytes, {.max_bytes = bytes.size() - 1}).status(),
              Fails(absl::StatusCode::kResourceExhausted,
                    absl::StrCat("at most ", size - 1, " bytes, got ", size)));
}

class RecorderTest : public ReplayTest {
 protected:
  void SetUp() override {
    ReplayTest::SetUp();
    service_ = *LocalServer::Start();
    connection_ = std::make_shared<client::Connection>(service_->address());
    recorder_ = *SessionRecorder::Start(*connection_, spec_, path_);
  }

  SessionLog Finished() {
    EXPECT_EQ(recorder_->Finish(), absl::OkStatus());
    return *ReadSessionLog(path_);
  }

  std::unique_ptr<LocalServer> service_;
  std::shared_ptr<client::Connection> connection_;
  std::unique_ptr<SessionRecorder> recorder_;
};

TEST_F(RecorderTest, MergedFramesAreOneAndKeepWhatCameBefore) {
  v1::TargetFrame other = FrameTo(2, 0.7);
  other.mutable_targets(0)->set_goal_index(1);
  recorder_->NoteSent(FrameTo(1, 0.1));
  recorder_->NoteSent(other);
  recorder_->NoteSent(FrameTo(3, 0.3));
  recorder_->NoteSent(FrameTo(4, 0.4));
  ASSERT_TRUE(recorder_->NoteAnswer(AnswerOf(3, 0)).ok());
  ASSERT_TRUE(recorder_->NoteAnswer(AnswerOf(4, 0)).ok());
  const SessionLog log = Finished();
  ASSERT_EQ(log.frames.frames().size(), 2);
  for (const auto& frame : log.frames.frames()) {
    ASSERT_EQ(frame.input.targets_size(), 2);
    for (const v1::GoalTarget& target : frame.input.targets()) {
      EXPECT_TRUE(target.has_weight());
      EXPECT_DOUBLE_EQ(
          target.world_position().x(),
          target.goal_index() == 1 ? 0.7 : 0.1 * frame.sequence_number);
    }
  }
}

TEST_F(RecorderTest, FramesThatAreRefusedAreLeftOut) {
  v1::PoseFrame refused = AnswerOf(1, 0);
  refused.mutable_status()->set_code(3);
  recorder_->NoteSent(FrameTo(1, 0.1));
  ASSERT_TRUE(recorder_->NoteAnswer(refused).ok());
  EXPECT_EQ(Finished().frames.frames().size(), 0);
}

TEST_F(RecorderTest, ChangesOfGoalsAreNotMerged) {
  recorder_->NoteSent(FrameTo(1, 0.1));
  v1::TargetFrame patch;
  patch.set_sequence_number(2);
  patch.mutable_goal_patch()->add_removed_goal_ids("stay");
  recorder_->NoteSent(patch);
  EXPECT_THAT(recorder_->NoteAnswer(AnswerOf(2, 0)),
              Fails(absl::StatusCode::kFailedPrecondition, "change goals"));
}

// Numbers that nobody solved for.
TEST_F(RecorderTest, AReplayFindsTheFirstFrameThatDiffers) {
  recorder_->NoteSent(FrameTo(1, 0.4));
  ASSERT_TRUE(recorder_->NoteAnswer(AnswerOf(1, 0)).ok());
  const auto result = ReplaySession(connection_, Finished(), [](int) {});
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->first_difference, 0);
  EXPECT_EQ(result->positions.size(), 7);
}

TEST_F(RecorderTest, AFrameThatTheServerRefusesIsNamed) {
  v1::TargetFrame bad = FrameTo(5, 0.4);
  bad.mutable_targets(0)->set_goal_index(9);
  auto writer = *SessionLogWriter::Open(path_, server_, spec_);
  ASSERT_TRUE(writer->Append(bad, AnswerOf(5, 0)).ok());
  ASSERT_TRUE(writer->Close().ok());
  const auto result =
      ReplaySession(connection_, *ReadSessionLog(path_), [](int) {});
  EXPECT_THAT(result.status(), Fails(kInvalid, "frame 0: "));
}

}  // namespace
}  // namespace gelenk::cli
