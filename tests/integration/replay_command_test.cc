// gelenk play --record and gelenk replay, with a service of their own and
// against a real gelenkd.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "client/cli/replay/session_log.h"
#include "gelenk/ik/instruction_set.h"
#include "tests/integration/command_test.h"

namespace gelenk {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ReplayCommandTest : public ServedCommandTest {
 protected:
  std::string Path(const char* name) const { return (folder_ / name).string(); }

  // The log at `from` once more, with a pose of frame `frame` nudged by the
  // smallest step there is.
  void Tamper(const char* from, size_t frame, const char* to) {
    const cli::SessionLog log = *cli::ReadSessionLog(Path(from));
    auto writer = *cli::SessionLogWriter::Open(Path(to), log.server, log.spec);
    for (size_t i = 0; i < log.frames.frames().size(); ++i) {
      const auto& logged = log.frames.frames()[i];
      v1::PoseFrame answer;
      answer.set_sequence_number(logged.sequence_number);
      answer.mutable_pose()->mutable_positions()->Assign(
          logged.positions.begin(), logged.positions.end());
      if (i == frame) {
        double* number = answer.mutable_pose()->mutable_positions()->Mutable(2);
        *number = std::nextafter(*number, 10);
      }
      ASSERT_TRUE(writer->Append(logged.input, answer).ok());
    }
    ASSERT_TRUE(writer->Close().ok());
  }
};

INSTANTIATE_TEST_SUITE_P(Hosts, ReplayCommandTest,
                         ::testing::Values(Host::kInProcess, Host::kServer),
                         HostName);

TEST_P(ReplayCommandTest, APlayedClipReplaysBitByBit) {
  const Ending played = Run({"play", "walk.bvh", "--record", "walk.log"});
  EXPECT_EQ(played.exit_code, 0) << played.err;
  EXPECT_THAT(played.out, HasSubstr("walk.log"));
  const Ending replayed = Run({"replay", "walk.log"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr("80 frames: joint angles are the same "
                                      "bit by bit"));
  const json result = RunJson({"replay", "walk.log"});
  EXPECT_EQ(result["same"], true);
  EXPECT_EQ(result["frames"], kFrames);
  EXPECT_EQ(result["same_level"], true);
  EXPECT_TRUE(result["first_difference"].is_null());
}

TEST_P(ReplayCommandTest, MergedFramesReplayToo) {
  EXPECT_EQ(
      Run({"play", "walk.bvh", "--policy", "latest", "--record", "walk.log"})
          .exit_code,
      0);
  EXPECT_EQ(RunJson({"replay", "walk.log"})["same"], true);
}

TEST_P(ReplayCommandTest, ARetargetedStreamReplaysToo) {
  const Ending made =
      Run({"retarget", "walk.bvh", "--onto", "humanoid", "--out", "out.bvh",
           "--live", "--record", "walk.log"});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(RunJson({"replay", "walk.log"})["same"], true);
  const Ending bad = Run({"retarget", "walk.bvh", "--onto", "humanoid", "--out",
                          "out.bvh", "--record", "walk.log"});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err, HasSubstr("--live"));
}

TEST_P(ReplayCommandTest, TheFirstFrameThatDiffersIsNamed) {
  ASSERT_EQ(Run({"play", "walk.bvh", "--record", "walk.log"}).exit_code, 0);
  Tamper("walk.log", 17, "other.log");
  const Ending ending = Run({"replay", "other.log"});
  EXPECT_EQ(ending.exit_code, 1);
  EXPECT_THAT(ending.err,
              AllOf(HasSubstr("\"other.log\": frame 17 (sequence_number 18) "
                              "differs: joint \"Hips\", number 2: "),
                    HasSubstr(" in the log, "), HasSubstr(" now")));
}

TEST_P(ReplayCommandTest, WhatIsNoLogIsToldByPlace) {
  ASSERT_EQ(Run({"play", "walk.bvh", "--record", "walk.log"}).exit_code, 0);
  const std::string bytes = Read(folder_ / "walk.log");
  Write("short.log", bytes.substr(0, bytes.size() - 100));
  const Ending cut = Run({"replay", "short.log"});
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_THAT(cut.err,
              AllOf(HasSubstr("\"short.log\": byte "), HasSubstr("cut off")));
  EXPECT_THAT(Run({"replay", "walk.bvh"}).err, HasSubstr("is no log"));
  EXPECT_THAT(Run({"replay", "none.log"}).err, HasSubstr("none.log"));
  EXPECT_EQ(Run({"play", "walk.bvh", "--record", "no/where.log"}).exit_code, 1);
}

class LevelTest : public CommandLineTest {};

TEST_F(LevelTest, AnotherLevelIsTold) {
  if (SupportedInstructionSets().size() < 2) {
    GTEST_SKIP() << "SKIPPED: this machine has one level";
  }
  testing::ServerProcess gelenkd(GELENKD, {"--isa", "baseline"});
  ASSERT_EQ(gelenkd.Start(), absl::OkStatus());
  server_ = gelenkd.target();
  ASSERT_EQ(Run({"play", "walk.bvh", "--record", "walk.log"}).exit_code, 0);
  EXPECT_EQ(RunJson({"replay", "walk.log"})["same_level"], true);
  // Bits may or may not be the same there.
  server_.clear();
  EXPECT_THAT(Run({"replay", "walk.log"}).out,
              HasSubstr("recorded on baseline, build "));
}

}  // namespace
}  // namespace gelenk
