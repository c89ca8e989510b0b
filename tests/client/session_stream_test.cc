// The stream against a server whose misfortunes are scripted. What counts is
// that nothing of them shows in the answers.
#include "gelenk/client/session_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "tests/testing/fake_session_server.h"

namespace gelenk::client {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using testing::FakeSessionServer;
using testing::Fate;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Lt;
using ::testing::SizeIs;

// No wait of a test that passes comes near it.
constexpr absl::Duration kPatience = absl::Seconds(20);

SessionSpec TwoGoalSpec(v1::FramePolicy policy) {
  SessionSpec spec;
  spec.skeleton.mutable_skeleton()->set_display_name("arithmetic");
  v1::Session* session = spec.session.mutable_session();
  for (const char* id : {"left", "right"}) {
    v1::Goal* goal = session->add_goals();
    goal->set_goal_id(id);
    goal->mutable_position()->set_end_effector_id(id);
    goal->mutable_position()->mutable_world_position()->set_y(0.25);
  }
  spec.frame_policy = policy;
  return spec;
}

// A frame that says only a part, and that a little differently each time.
v1::TargetFrame PartialFrame(int number) {
  v1::TargetFrame frame;
  v1::GoalTarget* target = frame.add_targets();
  target->set_goal_index(number % 2);
  target->mutable_world_position()->set_x(0.1 * number);
  if (number % 7 == 3) target->set_weight(1 + 0.01 * number);
  if (number % 11 == 5) {
    frame.mutable_world_from_skeleton()->mutable_translation()->set_z(number);
  }
  if (number % 13 == 8) {
    v1::Goal* goal = frame.mutable_goal_patch()->add_goals();
    goal->set_goal_id(absl::StrCat("extra", number));
    goal->mutable_position()->mutable_world_position()->set_x(number);
  }
  return frame;
}

SessionStreamOptions QuickOptions() {
  SessionStreamOptions options;
  options.backoff.floor = absl::Milliseconds(1);
  options.backoff.initial_ceiling = absl::Milliseconds(5);
  options.backoff.max_ceiling = absl::Milliseconds(50);
  options.silence_timeout = absl::Seconds(2);
  options.window = 8;
  options.seed = 1;
  return options;
}

class SessionStreamTest : public ::testing::Test {
 protected:
  absl::StatusOr<std::unique_ptr<SessionStream>> Open(
      FakeSessionServer& server, std::vector<SessionSpec> specs,
      const SessionStreamOptions& options = QuickOptions()) {
    return SessionStream::Open(std::make_shared<Connection>(server.target()),
                               options, std::move(specs));
  }

  // The answers to `count` frames, sent and received at the same time.
  std::vector<v1::PoseFrame> Play(SessionStream& stream, int count,
                                  int first = 1) {
    std::thread sender([&] {
      for (int i = first; i < first + count; ++i) {
        const auto sent = stream.SendNext(PartialFrame(i), kPatience);
        ASSERT_TRUE(sent.ok()) << sent.status();
      }
    });
    std::vector<v1::PoseFrame> answers;
    while (static_cast<int>(answers.size()) < count) {
      auto answer = stream.Receive(kPatience);
      EXPECT_TRUE(answer.ok()) << answer.status();
      if (!answer.ok() || !answer->has_value()) break;
      answers.push_back(**answer);
    }
    sender.join();
    return answers;
  }

  // What an undisturbed server answers.
  std::vector<std::vector<double>> Undisturbed(int count) {
    FakeSessionServer server;
    auto stream = Open(server, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
    EXPECT_TRUE(stream.ok()) << stream.status();
    return PositionsOf(Play(**stream, count));
  }

  static std::vector<std::vector<double>> PositionsOf(
      const std::vector<v1::PoseFrame>& answers) {
    std::vector<std::vector<double>> positions;
    for (const v1::PoseFrame& answer : answers) {
      positions.emplace_back(answer.pose().positions().begin(),
                             answer.pose().positions().end());
    }
    return positions;
  }

  FakeSessionServer server_;
};

TEST_F(SessionStreamTest, AnswersEveryFrameInOrder) {
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  const std::vector<v1::PoseFrame> answers = Play(**stream, 100);
  ASSERT_EQ(answers.size(), 100);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(answers[i].sequence_number(), i + 1);
  EXPECT_TRUE((*stream)->Close(kPatience).ok());
  EXPECT_EQ((*stream)->Receive(kPatience).status().code(),
            absl::StatusCode::kOutOfRange);
  EXPECT_EQ((*stream)->statistics().reconnects, 0);
  EXPECT_EQ((*stream)->statistics().round_trips.size(), 100);
}

struct Misfortune {
  const char* name;
  Fate fate;
  bool continues;
};

class MisfortuneTest : public SessionStreamTest,
                       public ::testing::WithParamInterface<Misfortune> {};

// The server keeps the session; only what was under way is lost.
TEST_P(MisfortuneTest, ShowsInNoAnswer) {
  server_.SetContinues(GetParam().continues);
  server_.SetScript([](const v1::TargetFrame&, int count) {
    return count % 23 == 16 ? GetParam().fate : Fate::kAnswer;
  });
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  EXPECT_EQ(PositionsOf(Play(**stream, 100)), Undisturbed(100));
}

INSTANTIATE_TEST_SUITE_P(
    Each, MisfortuneTest,
    ::testing::Values(Misfortune{"lost_after_solve", Fate::kDropAfter, true},
                      Misfortune{"drained", Fate::kDrain, true},
                      Misfortune{"answered_twice", Fate::kAnswerTwice, true}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_F(SessionStreamTest, ServerKilledAgainAndAgainShowsInNoAnswer) {
  std::atomic<bool> done = false;
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  server_.SetScript([](const v1::TargetFrame&, int) {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    return Fate::kAnswer;
  });
  std::thread killer([&] {
    while (!done) {
      std::this_thread::sleep_for(std::chrono::milliseconds(40));
      server_.Stop();
      server_.Start();
    }
  });
  const std::vector<v1::PoseFrame> answers = Play(**stream, 500);
  done = true;
  killer.join();
  EXPECT_EQ(PositionsOf(answers), Undisturbed(500));
  EXPECT_GE((*stream)->statistics().recreated_sessions, 1);
}

}  // namespace
}  // namespace gelenk::client
