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

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "tests/testing/fake_session_server.h"

namespace gelenk::client {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using testing::FakeSessionServer;
using testing::Fate;
using ::testing::Ge;
using ::testing::HasSubstr;
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
      if (!answer.ok()) break;
      EXPECT_TRUE(answer->has_value()) << "after " << answers.size();
      if (!answer->has_value()) break;
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

TEST_F(SessionStreamTest, TakesNumbersOfTheCaller) {
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  for (int64_t number : {10, 20, 21}) {
    v1::TargetFrame frame = PartialFrame(1);
    frame.set_sequence_number(number);
    EXPECT_TRUE((*stream)->Send(frame).ok());
  }
  v1::TargetFrame frame;
  frame.set_sequence_number(21);
  EXPECT_TRUE(absl::IsInvalidArgument((*stream)->Send(frame)));
  frame.set_slot(1);
  EXPECT_TRUE(absl::IsInvalidArgument((*stream)->Send(frame)));
  EXPECT_EQ((*stream)->LastSequenceNumber(0), 21);
  EXPECT_EQ(*(*stream)->SendNext(PartialFrame(1)), 22);
  EXPECT_TRUE((*stream)->Close(kPatience).ok());
}

TEST_F(SessionStreamTest, BadFrameIsAnAnswerAndTheStreamLives) {
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  v1::TargetFrame bad = PartialFrame(1);
  bad.mutable_targets(0)->mutable_world_position()->set_x(
      std::numeric_limits<double>::quiet_NaN());
  ASSERT_TRUE((*stream)->SendNext(bad).ok());
  auto answer = (*stream)->Receive(kPatience);
  ASSERT_TRUE(answer.ok() && answer->has_value()) << answer.status();
  EXPECT_EQ((*answer)->status().code(), 3);
  EXPECT_EQ(PositionsOf(Play(**stream, 20)), Undisturbed(20));
}

TEST_F(SessionStreamTest, FullWindowHoldsTheSender) {
  server_.SetScript([](const auto&, int) { return Fate::kIgnore; });
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  for (int i = 0; i < QuickOptions().window; ++i) {
    ASSERT_TRUE((*stream)->SendNext(PartialFrame(i)).ok());
  }
  EXPECT_TRUE(absl::IsDeadlineExceeded(
      (*stream)->SendNext(PartialFrame(9), absl::Milliseconds(20)).status()));
}

TEST_F(SessionStreamTest, EveryStreamCarriesTheAffinityKey) {
  server_.SetScript([](const auto&, int count) {
    return count == 3 ? Fate::kDropBefore : Fate::kAnswer;
  });
  SessionSpec spec = TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME);
  spec.session.mutable_session()->set_affinity_key("stage-7");
  auto stream = Open(server_, {spec});
  ASSERT_TRUE(stream.ok()) << stream.status();
  Play(**stream, 5);
  EXPECT_THAT(server_.affinity_keys(), AllOf(SizeIs(Ge(2)), Each("stage-7")));
}

// --- Opening ---

TEST_F(SessionStreamTest, OpenRetriesWhatPasses) {
  server_.RefuseCalls(3, absl::UnavailableError("not yet"));
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  EXPECT_TRUE(stream.ok()) << stream.status();
}

TEST_F(SessionStreamTest, OpenReportsWhatStays) {
  server_.RefuseCalls(1, absl::ResourceExhaustedError("64 skeletons"));
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  EXPECT_TRUE(absl::IsResourceExhausted(stream.status())) << stream.status();

  server_.RefuseAttaches(1, absl::FailedPreconditionError("has a driver"));
  stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  EXPECT_TRUE(absl::IsFailedPrecondition(stream.status())) << stream.status();
}

TEST_F(SessionStreamTest, OpenGivesUpWithoutAServer) {
  server_.Stop();
  SessionStreamOptions options = QuickOptions();
  options.open_timeout = absl::Milliseconds(300);
  const absl::Time start = absl::Now();
  auto stream =
      Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)}, options);
  EXPECT_TRUE(absl::IsUnavailable(stream.status())) << stream.status();
  EXPECT_LT(absl::Now() - start, absl::Seconds(5));
}

TEST_F(SessionStreamTest, TwoClientsOfOneIdDoNotShareByAccident) {
  SessionSpec spec = TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME);
  spec.session.set_session_id("left-arm");
  auto first = Open(server_, {spec});
  ASSERT_TRUE(first.ok()) << first.status();
  SessionStreamOptions options = QuickOptions();
  options.seed = 2;
  EXPECT_TRUE(absl::IsAlreadyExists(Open(server_, {spec}, options).status()));
}

TEST_F(SessionStreamTest, AdoptsASessionAndBringsItBack) {
  std::vector<std::vector<double>> positions;
  SessionSpec adopted;
  {
    auto first = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
    ASSERT_TRUE(first.ok()) << first.status();
    positions = PositionsOf(Play(**first, 30));
    adopted.session.set_session_id((*first)->specs()[0].session.session_id());
    ASSERT_TRUE((*first)->Close(kPatience).ok());
  }
  adopted.frame_policy = v1::FRAME_POLICY_EVERY_FRAME;
  auto second = Open(server_, {adopted});
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ((*second)->LastSequenceNumber(0), 30);
  for (int first : {31, 61}) {
    for (const auto& next : PositionsOf(Play(**second, 30, first))) {
      positions.push_back(next);
    }
    if (first > 31) break;
    server_.Stop();
    server_.Start();
  }
  EXPECT_EQ(positions, Undisturbed(90));
  EXPECT_EQ((*second)->statistics().recreated_sessions, 1);
}

// --- Loss ---

struct Misfortune {
  const char* name;
  Fate fate;
  bool continues;
};

bool IsLoss(Fate fate) {
  return fate == Fate::kDropBefore || fate == Fate::kDropAfter;
}

class MisfortuneTest : public SessionStreamTest,
                       public ::testing::WithParamInterface<Misfortune> {};

// The server keeps the session; only what was under way is lost.
TEST_P(MisfortuneTest, ShowsInNoAnswer) {
  server_.SetContinues(GetParam().continues);
  // The server gets four frames ahead before it happens.
  server_.SetScript([](const v1::TargetFrame&, int count) {
    const int turn = count % 23;
    if (turn == 20) return GetParam().fate;
    return turn >= 16 && turn < 20 && IsLoss(GetParam().fate) ? Fate::kIgnore
                                                              : Fate::kAnswer;
  });
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  EXPECT_EQ(PositionsOf(Play(**stream, 100)), Undisturbed(100));
}

INSTANTIATE_TEST_SUITE_P(
    Each, MisfortuneTest,
    ::testing::Values(
        Misfortune{"lost_before_solve", Fate::kDropBefore, true},
        Misfortune{"lost_after_solve", Fate::kDropAfter, true},
        Misfortune{"lost_before_solve_uncontinued", Fate::kDropBefore, false},
        Misfortune{"lost_after_solve_uncontinued", Fate::kDropAfter, false},
        Misfortune{"drained", Fate::kDrain, true},
        Misfortune{"drained_uncontinued", Fate::kDrain, false},
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

TEST_F(SessionStreamTest, LossBeforeTheFirstAnswerStartsColdAgain) {
  server_.SetScript([](const auto&, int count) {
    if (count < 4) return Fate::kIgnore;
    return count == 4 ? Fate::kDropAfter : Fate::kAnswer;
  });
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  EXPECT_EQ(PositionsOf(Play(**stream, 5)), Undisturbed(5));
  EXPECT_EQ(server_.delete_count(), 1);
}

TEST_F(SessionStreamTest, SilentServerIsALoss) {
  SessionStreamOptions options = QuickOptions();
  options.silence_timeout = absl::Milliseconds(200);
  server_.SetScript([](const auto&, int count) {
    return count >= 10 && count < 12 ? Fate::kIgnore : Fate::kAnswer;
  });
  auto stream =
      Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)}, options);
  ASSERT_TRUE(stream.ok()) << stream.status();
  EXPECT_EQ(PositionsOf(Play(**stream, 12)), Undisturbed(12));
  EXPECT_GE((*stream)->statistics().reconnects, 1);
}

TEST_F(SessionStreamTest, OwnGhostIsWaitedFor) {
  server_.SetScript([](const auto&, int count) {
    return count == 5 ? Fate::kDropAfter : Fate::kAnswer;
  });
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  server_.RefuseAttaches(3, absl::FailedPreconditionError("has a driver"));
  EXPECT_EQ(PositionsOf(Play(**stream, 10)), Undisturbed(10));
  for (const v1::AttachSession& attach : server_.attaches()) {
    EXPECT_FALSE(attach.take_over());
  }
}

TEST_F(SessionStreamTest, TwoSlotsComeBackTogether) {
  std::vector<SessionSpec> specs(2, TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME));
  for (SessionSpec& spec : specs) {
    spec.skeleton.set_skeleton_id("shared");
    spec.session.mutable_session()->set_affinity_key("stage");
  }
  auto stream = Open(server_, specs);
  ASSERT_TRUE(stream.ok()) << stream.status();
  std::vector<std::vector<v1::PoseFrame>> answers(2);
  for (int i = 1; i <= 60; ++i) {
    for (int slot : {0, 1}) {
      v1::TargetFrame frame = PartialFrame(i);
      frame.set_slot(slot);
      ASSERT_TRUE((*stream)->SendNext(frame, kPatience).ok());
    }
    if (i % 20 == 7) {
      server_.Stop();
      server_.Start();
    }
  }
  ASSERT_TRUE((*stream)->Close(kPatience).ok());
  for (auto answer = (*stream)->Receive(kPatience); answer.ok();
       answer = (*stream)->Receive(kPatience)) {
    answers[(*answer)->slot()].push_back(**answer);
  }
  EXPECT_EQ(PositionsOf(answers[0]), Undisturbed(60));
  EXPECT_EQ(PositionsOf(answers[1]), Undisturbed(60));
}

TEST_F(SessionStreamTest, GivesUpInTime) {
  SessionStreamOptions options = QuickOptions();
  options.give_up_after = absl::Milliseconds(300);
  auto stream =
      Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)}, options);
  ASSERT_TRUE(stream.ok()) << stream.status();
  server_.Stop();
  // The sender blocks with a full window, and is let go with the reason.
  absl::Status sent;
  while (sent.ok()) sent = (*stream)->SendNext(PartialFrame(1)).status();
  EXPECT_TRUE(absl::IsUnavailable(sent)) << sent;
  EXPECT_TRUE(absl::IsUnavailable((*stream)->Receive(kPatience).status()));
  EXPECT_TRUE(absl::IsUnavailable((*stream)->Receive(kPatience).status()));
  EXPECT_TRUE(absl::IsUnavailable((*stream)->Close(kPatience)));
}

// --- Ends that stay ---

TEST_F(SessionStreamTest, TakenOverIsToldAndNotTakenBack) {
  server_.SetScript([](const auto&, int count) {
    return count == 2 ? Fate::kTakeOver : Fate::kAnswer;
  });
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE((*stream)->SendNext(PartialFrame(i)).ok());
  }
  for (int i = 1; i <= 2; ++i) {
    ASSERT_TRUE((*stream)->Receive(kPatience)->has_value());
  }
  EXPECT_TRUE(absl::IsAborted((*stream)->Receive(kPatience).status()));
  EXPECT_TRUE(absl::IsAborted((*stream)->SendNext(PartialFrame(4)).status()));
  EXPECT_TRUE(absl::IsAborted((*stream)->Close(kPatience)));
  EXPECT_EQ(server_.attach_count(), 1);
}

TEST_F(SessionStreamTest, OtherSlotsGoOn) {
  server_.SetScript([](const v1::TargetFrame& frame, int) {
    return frame.slot() == 1 ? Fate::kTakeOver : Fate::kAnswer;
  });
  std::vector<SessionSpec> specs(2, TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME));
  for (SessionSpec& spec : specs) {
    spec.session.mutable_session()->set_affinity_key("stage");
  }
  auto stream = Open(server_, specs);
  ASSERT_TRUE(stream.ok()) << stream.status();
  v1::TargetFrame frame = PartialFrame(1);
  frame.set_slot(1);
  ASSERT_TRUE((*stream)->SendNext(frame).ok());
  EXPECT_TRUE(absl::IsAborted((*stream)->Receive(kPatience).status()));
  EXPECT_EQ(PositionsOf(Play(**stream, 20)), Undisturbed(20));
  EXPECT_TRUE(absl::IsAborted((*stream)->Close(kPatience)));
}

TEST_F(SessionStreamTest, ClosingIsToldWithItsReason) {
  server_.SetScript([](const auto&, int count) {
    return count == 1 ? Fate::kClose : Fate::kAnswer;
  });
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  for (int i = 1; i <= 2; ++i) {
    ASSERT_TRUE((*stream)->SendNext(PartialFrame(i)).ok());
  }
  EXPECT_TRUE((*stream)->Receive(kPatience)->has_value());
  EXPECT_TRUE(
      absl::IsResourceExhausted((*stream)->Receive(kPatience).status()));
  EXPECT_TRUE(absl::IsResourceExhausted((*stream)->Close(kPatience)));
}

// --- Close ---

TEST_F(SessionStreamTest, CloseWaitsForTheAnswers) {
  server_.SetScript([](const auto&, int count) {
    return count == 6 ? Fate::kDropAfter : Fate::kAnswer;
  });
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  for (int i = 1; i <= 8; ++i) {
    ASSERT_TRUE((*stream)->SendNext(PartialFrame(i)).ok());
  }
  EXPECT_TRUE((*stream)->Close(kPatience).ok());
  EXPECT_TRUE(absl::IsCancelled((*stream)->SendNext({}).status()));
  std::vector<v1::PoseFrame> answers;
  auto answer = (*stream)->Receive(kPatience);
  for (; answer.ok(); answer = (*stream)->Receive(kPatience)) {
    answers.push_back(**answer);
  }
  EXPECT_TRUE(absl::IsOutOfRange(answer.status()));
  EXPECT_EQ(PositionsOf(answers), Undisturbed(8));
}

TEST_F(SessionStreamTest, CloseIsBounded) {
  server_.SetScript([](const auto&, int) { return Fate::kIgnore; });
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  ASSERT_TRUE((*stream)->SendNext(PartialFrame(1)).ok());
  const absl::Status status = (*stream)->Close(absl::Milliseconds(50));
  EXPECT_TRUE(absl::IsDeadlineExceeded(status));
  EXPECT_THAT(status.ToString(), HasSubstr("1 frames"));
}

TEST_F(SessionStreamTest, CloseAndDestructionDoNotNeedAServer) {
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  auto other = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  ASSERT_TRUE((*stream)->SendNext(PartialFrame(1)).ok());
  ASSERT_TRUE((*stream)->Receive(kPatience)->has_value());
  server_.Stop();
  EXPECT_TRUE((*stream)->Close(kPatience).ok());
}

TEST_F(SessionStreamTest, CloseLetsABlockedSenderGo) {
  server_.SetScript([](const auto&, int) { return Fate::kIgnore; });
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_EVERY_FRAME)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  std::thread sender([&] {
    absl::Status sent;
    while (sent.ok()) sent = (*stream)->SendNext(PartialFrame(1)).status();
    EXPECT_TRUE(absl::IsCancelled(sent)) << sent;
  });
  std::thread receiver([&] {
    EXPECT_TRUE(absl::IsDeadlineExceeded(
        (*stream)->Receive(absl::InfiniteDuration()).status()));
  });
  absl::SleepFor(absl::Milliseconds(20));
  EXPECT_TRUE(
      absl::IsDeadlineExceeded((*stream)->Close(absl::Milliseconds(50))));
  sender.join();
  receiver.join();
}

// --- LATEST_WINS ---

TEST_F(SessionStreamTest, LatestWinsNeverBlocksAndSendsTheNewest) {
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_LATEST_WINS)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  server_.Stop();
  for (int i = 1; i <= 1000; ++i) {
    v1::TargetFrame frame;
    frame.add_targets()->mutable_world_position()->set_x(i);
    ASSERT_TRUE((*stream)->SendNext(frame, absl::ZeroDuration()).ok());
  }
  server_.Start();
  auto answer = (*stream)->Receive(kPatience);
  ASSERT_TRUE(answer.ok() && answer->has_value()) << answer.status();
  EXPECT_EQ((*answer)->sequence_number(), 1000);
  EXPECT_GE((*stream)->statistics().merged_frames, 990);
  EXPECT_EQ(server_.frames().back().targets(0).world_position().x(), 1000);
}

TEST_F(SessionStreamTest, LatestWinsKeepsEveryGoalsNewestTarget) {
  auto stream = Open(server_, {TwoGoalSpec(v1::FRAME_POLICY_LATEST_WINS)});
  ASSERT_TRUE(stream.ok()) << stream.status();
  std::thread killer([&] {
    for (int i = 0; i < 3; ++i) {
      absl::SleepFor(absl::Milliseconds(30));
      server_.Stop();
      server_.Start();
    }
  });
  int64_t last = 0;
  for (int i = 1; i <= 300; ++i) {
    auto sent = (*stream)->SendNext(PartialFrame(i % 8));
    ASSERT_TRUE(sent.ok()) << sent.status();
    last = *sent;
    absl::SleepFor(absl::Microseconds(300));
  }
  killer.join();
  ASSERT_TRUE((*stream)->Close(kPatience).ok());
  int64_t newest = 0;
  for (auto answer = (*stream)->Receive(kPatience); answer.ok();
       answer = (*stream)->Receive(kPatience)) {
    EXPECT_GT((*answer)->sequence_number(), newest);
    newest = (*answer)->sequence_number();
  }
  EXPECT_EQ(newest, last);
}

}  // namespace
}  // namespace gelenk::client
