// Servers are killed and drained under a stream; what the stream answers must
// be, bit for bit, what it answers without.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "convert/skeleton.h"
#include "gelenk/client/session_stream.h"
#include "tests/testing/example_bodies.h"
#include "tests/testing/random.h"
#include "tests/testing/server_process.h"
#include "tests/testing/tcp_relay.h"

namespace gelenk::client {
namespace {

using gelenk::testing::Random;
using gelenk::testing::ServerProcess;
using gelenk::testing::TcpRelay;

// No wait of a test that passes comes near it.
constexpr absl::Duration kPatience = absl::Seconds(30);
constexpr int kFrames = 600;

SessionSpec BodySpec(v1::FramePolicy policy) {
  SessionSpec spec;
  convert::ToProto(*gelenk::testing::PersonWithFingers(),
                   spec.skeleton.mutable_skeleton());
  for (const char* effector : {"left_palm", "right_palm", "crown"}) {
    v1::Goal* goal = spec.session.mutable_session()->add_goals();
    goal->set_goal_id(effector);
    goal->mutable_position()->set_end_effector_id(effector);
  }
  spec.frame_policy = policy;
  return spec;
}

// Hands that swing; a frame says only a part of it, in different ways.
v1::TargetFrame SwingFrame(int number) {
  const double phase = 0.02 * number;
  v1::TargetFrame frame;
  for (int goal = 0; goal < 3; ++goal) {
    if (number > 1 && (number + goal) % 3 == 0) continue;
    v1::GoalTarget* target = frame.add_targets();
    target->set_goal_index(goal);
    const double side = goal == 0 ? 1 : goal == 1 ? -1 : 0;
    v1::Vector3* position = target->mutable_world_position();
    position->set_x(0.4 * side + 0.1 * std::sin(phase + goal));
    position->set_y(goal == 2 ? 1.6 : 1.2 + 0.1 * std::cos(phase));
    position->set_z(0.2 + 0.1 * std::sin(1.7 * phase));
    if (number % 50 == 20 + goal) target->set_weight(0.5 + 0.01 * number);
  }
  if (number % 90 == 60) {
    frame.mutable_world_from_skeleton()->mutable_translation()->set_x(0.001 *
                                                                      number);
  }
  if (number % 200 == 100) {
    v1::Goal* goal = frame.mutable_goal_patch()->add_goals();
    goal->set_goal_id(absl::StrCat("sole", number));
    goal->mutable_position()->set_end_effector_id("left_sole");
    goal->mutable_position()->mutable_world_position()->set_x(0.1);
  }
  return frame;
}

// Every goal, nothing else: answers carry no continuation.
v1::TargetFrame PlainFrame(int number) {
  v1::TargetFrame frame = SwingFrame(1);
  for (v1::GoalTarget& target : *frame.mutable_targets()) {
    v1::Vector3* position = target.mutable_world_position();
    position->set_z(position->z() + 0.1 * std::sin(0.02 * number));
  }
  return frame;
}

// Plain ones, and in between some that only a continuation or a complete frame
// makes good: with a goal left out, a weight, a new goal.
v1::TargetFrame MixedFrame(int number) {
  v1::TargetFrame frame = PlainFrame(number);
  if (number % 4 == 1) frame.mutable_targets()->DeleteSubrange(1, 1);
  if (number == 500) frame.mutable_targets(0)->set_weight(0.7);
  if (number == 400) *frame.mutable_goal_patch() = SwingFrame(100).goal_patch();
  return frame;
}

using MakeFrame = v1::TargetFrame (*)(int number);
// Called in the receiving thread, after the n-th answer.
using Disturb = std::function<void(int answer_count)>;

using Positions = std::vector<double>;

class StreamLossTest : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(server_.Start(), absl::OkStatus()); }

  std::unique_ptr<SessionStream> Open(
      v1::FramePolicy policy, std::string target = "",
      const SessionStreamOptions& options = {}) {
    if (target.empty()) target = server_.target();
    auto stream = SessionStream::Open(std::make_shared<Connection>(target),
                                      options, {BodySpec(policy)});
    EXPECT_TRUE(stream.ok()) << stream.status();
    return stream.ok() ? *std::move(stream) : nullptr;
  }

  // The joint angles of every frame.
  std::vector<Positions> Play(SessionStream& stream, MakeFrame make_frame,
                              const Disturb& disturb = nullptr) {
    std::thread sender([&] {
      for (int i = 1; i <= kFrames; ++i) {
        const auto sent = stream.SendNext(make_frame(i), kPatience);
        ASSERT_TRUE(sent.ok()) << sent.status();
      }
    });
    std::vector<Positions> positions;
    for (int i = 1; i <= kFrames; ++i) {
      const auto answer = stream.Receive(kPatience);
      EXPECT_TRUE(answer.ok() && answer->has_value())
          << "frame " << i << ": " << answer.status();
      if (!answer.ok() || !answer->has_value()) break;
      EXPECT_EQ((*answer)->sequence_number(), i);
      EXPECT_EQ((*answer)->status().code(), 0) << (*answer)->DebugString();
      const v1::Pose& pose = (*answer)->pose();
      positions.emplace_back(pose.positions().begin(), pose.positions().end());
      if (disturb != nullptr) disturb(i);
    }
    sender.join();
    return positions;
  }

  std::vector<Positions> Undisturbed(MakeFrame make_frame) {
    const auto stream = Open(v1::FRAME_POLICY_EVERY_FRAME);
    return Play(*stream, make_frame);
  }

  void ExpectSame(const std::vector<Positions>& disturbed,
                  const std::vector<Positions>& undisturbed) {
    ASSERT_EQ(disturbed.size(), undisturbed.size());
    for (size_t i = 0; i < disturbed.size(); ++i) {
      ASSERT_EQ(disturbed[i], undisturbed[i]) << "from frame " << i + 1;
    }
  }

  ServerProcess server_{GELENKD, {"--log-level", "error", "--drain", "5s"}};
};

class KilledServerTest : public StreamLossTest,
                         public ::testing::WithParamInterface<uint64_t> {
 protected:
  // SIGKILL and restart after some answers, the first ones among them.
  Disturb KillSometimes() {
    Random random(GetParam());
    std::set<int> moments;
    for (int i = 0; i < 3; ++i) {
      moments.insert(1 + gelenk::testing::UniformIndex(random, kFrames - 1));
    }
    if (GetParam() % 2 == 0) moments.insert(1);
    return [this, moments](int answer_count) {
      if (moments.count(answer_count) == 0) return;
      server_.Kill();
      ASSERT_EQ(server_.Start(), absl::OkStatus());
    };
  }
};

TEST_P(KilledServerTest, ShowsInNoAngle) {
  const std::vector<Positions> undisturbed = Undisturbed(SwingFrame);
  const auto stream = Open(v1::FRAME_POLICY_EVERY_FRAME);
  ExpectSame(Play(*stream, SwingFrame, KillSometimes()), undisturbed);
  EXPECT_EQ(stream->Close(kPatience), absl::OkStatus());
  EXPECT_GE(stream->statistics().recreated_sessions, 1);
  EXPECT_EQ(stream->statistics().inexact_resumes, 0);
}

TEST_P(KilledServerTest, ShowsInNoAngleWithoutContinuation) {
  const std::vector<Positions> undisturbed = Undisturbed(PlainFrame);
  const auto stream = Open(v1::FRAME_POLICY_EVERY_FRAME);
  ExpectSame(Play(*stream, PlainFrame, KillSometimes()), undisturbed);
}

INSTANTIATE_TEST_SUITE_P(Seeds, KilledServerTest,
                         ::testing::Range<uint64_t>(1, 6));

TEST_F(StreamLossTest, ServerKilledBeforeTheFirstAnswerStartsColdAgain) {
  const std::vector<Positions> undisturbed = Undisturbed(SwingFrame);
  const auto stream = Open(v1::FRAME_POLICY_EVERY_FRAME);
  server_.Kill();
  std::thread starter([this] {
    absl::SleepFor(absl::Milliseconds(100));
    ASSERT_EQ(server_.Start(), absl::OkStatus());
  });
  ExpectSame(Play(*stream, SwingFrame), undisturbed);
  starter.join();
}

TEST_F(StreamLossTest, DrainedServerHandsOver) {
  const std::vector<Positions> undisturbed = Undisturbed(SwingFrame);
  const auto stream = Open(v1::FRAME_POLICY_EVERY_FRAME);
  std::thread operator_thread;
  int exit_code = -1;
  // Answers keep coming while the server drains.
  const auto drain = [&](int answer_count) {
    if (answer_count != kFrames / 3) return;
    operator_thread = std::thread([&] {
      exit_code = server_.Terminate(kPatience);
      ASSERT_EQ(server_.Start(), absl::OkStatus());
    });
  };
  ExpectSame(Play(*stream, SwingFrame, drain), undisturbed);
  // The stream may have come to its end on the old server.
  EXPECT_EQ(stream->Close(kPatience), absl::OkStatus());
  operator_thread.join();
  EXPECT_EQ(exit_code, 0);
}

// The session lives on, ahead of its client.
class BrokenNetworkTest : public StreamLossTest,
                          public ::testing::WithParamInterface<MakeFrame> {};

TEST_P(BrokenNetworkTest, CutShowsInNoAngle) {
  const std::vector<Positions> undisturbed = Undisturbed(GetParam());
  TcpRelay relay(server_.port());
  const auto stream = Open(v1::FRAME_POLICY_EVERY_FRAME, relay.target());
  const auto cut = [&relay](int answer_count) {
    if (answer_count % 31 != 8) return;
    // Time for the server to get a window ahead.
    relay.Deafen();
    absl::SleepFor(absl::Milliseconds(5));
    relay.Cut();
  };
  ExpectSame(Play(*stream, GetParam(), cut), undisturbed);
  EXPECT_GE(stream->statistics().reconnects, 5);
}

TEST_P(BrokenNetworkTest, SilenceShowsInNoAngle) {
  const std::vector<Positions> undisturbed = Undisturbed(GetParam());
  TcpRelay relay(server_.port());
  SessionStreamOptions options;
  options.silence_timeout = absl::Milliseconds(300);
  const auto stream =
      Open(v1::FRAME_POLICY_EVERY_FRAME, relay.target(), options);
  std::thread mender;
  const auto freeze = [&](int answer_count) {
    if (answer_count != kFrames / 2) return;
    relay.Freeze();
    // Until the old connection is reset, the server sees a driver in it.
    mender = std::thread([&relay] {
      absl::SleepFor(absl::Seconds(1));
      relay.Cut();
    });
  };
  ExpectSame(Play(*stream, GetParam(), freeze), undisturbed);
  mender.join();
  EXPECT_GE(stream->statistics().reconnects, 1);
}

INSTANTIATE_TEST_SUITE_P(Frames, BrokenNetworkTest,
                         ::testing::Values(SwingFrame, PlainFrame, MixedFrame));

TEST_F(StreamLossTest, LatestWinsReachesTheNewestTargets) {
  const auto stream = Open(v1::FRAME_POLICY_LATEST_WINS);
  std::thread killer([this] {
    for (int i = 0; i < 3; ++i) {
      absl::SleepFor(absl::Milliseconds(150));
      server_.Kill();
      ASSERT_EQ(server_.Start(), absl::OkStatus());
    }
  });
  absl::Duration longest;
  for (int i = 1; i <= kFrames; ++i) {
    const absl::Time before = absl::Now();
    ASSERT_TRUE(stream->SendNext(PlainFrame(i)).ok());
    longest = std::max(longest, absl::Now() - before);
    absl::SleepFor(absl::Milliseconds(1));
  }
  killer.join();
  ASSERT_EQ(stream->Close(kPatience), absl::OkStatus());
  int64_t newest = 0;
  v1::PoseFrame last;
  for (auto answer = stream->Receive(kPatience); answer.ok();
       answer = stream->Receive(kPatience)) {
    ASSERT_TRUE(answer->has_value());
    EXPECT_GT((*answer)->sequence_number(), newest);
    newest = (*answer)->sequence_number();
    last = **answer;
  }
  EXPECT_EQ(newest, kFrames);
  EXPECT_EQ(last.report().outcome(), v1::SolveReport::OUTCOME_CONVERGED);
  EXPECT_GE(stream->statistics().reconnects, 1);
  // It merges, it does not wait for the server (starting one takes longer).
  EXPECT_LT(longest, absl::Milliseconds(100));
}

}  // namespace
}  // namespace gelenk::client
