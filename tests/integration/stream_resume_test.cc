// A stream goes on where another one ended: the client gives back its last
// answer. Bits are compared with a stream that never ended.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/integration/service_test.h"
#include "tests/testing/random.h"

namespace gelenk {
namespace {

using testing::AttachRequest;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kPatience;
using ::testing::Not;
using testing::ServerProcess;
using ::testing::SizeIs;
using testing::SolveStream;
using testing::WholeFrame;
using v1::StreamEvent;

constexpr int kFrames = 60;
constexpr int kInvalidArgument = 3;
constexpr int kFailedPrecondition = 9;

using Positions = std::vector<double>;

Positions PositionsOf(const v1::PoseFrame& frame) {
  return {frame.pose().positions().begin(), frame.pose().positions().end()};
}

// Leaves something behind in the session that later frames do not repeat: a
// goal that is not named, a weight, a place, another goal.
v1::TargetFrame LastingFrame(int number) {
  v1::TargetFrame frame = WholeFrame(number);
  if (number % 3 == 0) frame.mutable_targets()->DeleteSubrange(1, 1);
  if (number == 8) frame.mutable_targets(1)->set_weight(0.03);
  if (number == 11) {
    frame.mutable_world_from_skeleton()->mutable_translation()->set_y(0.05);
  }
  if (number == 14) {
    v1::Goal* goal = frame.mutable_goal_patch()->add_goals();
    goal->set_goal_id("elbow");
    goal->set_weight(0.2);
    goal->mutable_position()->set_end_effector_id("j2");
    goal->mutable_position()->mutable_world_position()->set_x(0.6);
  }
  return frame;
}

using MakeFrame = v1::TargetFrame (*)(int number);

v1::TargetFrame PlainFrame(int number) { return WholeFrame(number); }

class StreamResumeTest : public ServiceTest {
 protected:
  // Sends frames `first` .. kFrames and appends their answers.
  static void Play(SolveStream& stream, MakeFrame make_frame, int first,
                   std::vector<v1::PoseFrame>& answers) {
    v1::StreamingSolveRequest request;
    for (int i = first; i <= kFrames; ++i) {
      *request.add_frames() = make_frame(i);
    }
    ASSERT_TRUE(stream.Send(request));
    for (v1::PoseFrame& answer : stream.NextFrames(kFrames - first + 1)) {
      ASSERT_EQ(answer.status().code(), 0) << answer.status().message();
      answers.push_back(answer);
    }
    ASSERT_THAT(answers, SizeIs(kFrames));
  }

  static std::vector<v1::PoseFrame> Undisturbed(MakeFrame make_frame) {
    const auto stream = OpenStream({AttachRequest(CreateSession())});
    std::vector<v1::PoseFrame> answers;
    Play(*stream, make_frame, 1, answers);
    return answers;
  }

  static v1::AttachSession ResumeRequest(const std::string& session,
                                         const v1::PoseFrame& last) {
    v1::AttachSession attach = AttachRequest(session);
    *attach.mutable_resume_from() = last;
    return attach;
  }

  static StreamEvent EventOf(SolveStream& stream,
                             const v1::AttachSession& attach) {
    EXPECT_TRUE(stream.Attach(attach));
    const auto event = stream.NextNews();
    EXPECT_TRUE(event);
    return event.value_or(StreamEvent());
  }
};

class ExactResumeTest : public StreamResumeTest,
                        public ::testing::WithParamInterface<MakeFrame> {};

// In a session that knows nothing of what came before.
TEST_P(ExactResumeTest, InAFreshSession) {
  const std::vector<v1::PoseFrame> all = Undisturbed(GetParam());
  for (int last : {1, 7, 8, 9, 13, 15, 30, kFrames - 1}) {
    const auto stream = OpenStream();
    const StreamEvent event =
        EventOf(*stream, ResumeRequest(CreateSession(), all[last - 1]));
    EXPECT_EQ(event.kind(), StreamEvent::KIND_ATTACHED);
    EXPECT_EQ(event.sequence_number(), last);
    EXPECT_EQ(event.status().code(), 0) << event.status().message();
    std::vector<v1::PoseFrame> answers(all.begin(), all.begin() + last);
    Play(*stream, GetParam(), last + 1, answers);
    for (int i = last; i < kFrames; ++i) {
      ASSERT_EQ(PositionsOf(answers[i]), PositionsOf(all[i]))
          << "resumed from " << last << ", frame " << i + 1;
    }
  }
}

// In the old session, which is ahead of its client.
TEST_P(ExactResumeTest, InTheSessionThatWentOn) {
  const std::string session = CreateSession();
  const auto before = OpenStream({AttachRequest(session)});
  std::vector<v1::PoseFrame> all;
  Play(*before, GetParam(), 1, all);
  const auto after = OpenStream();
  v1::AttachSession attach = ResumeRequest(session, all[29]);
  attach.set_take_over(true);
  EXPECT_EQ(EventOf(*after, attach).sequence_number(), 30);
  std::vector<v1::PoseFrame> answers(all.begin(), all.begin() + 30);
  if (GetParam() == LastingFrame) {
    // Without a continuation nothing tells that frame 14 is in the past.
    ASSERT_THAT(all[29].continuation(), Not(IsEmpty()));
  }
  Play(*after, GetParam(), 31, answers);
  for (int i = 30; i < kFrames; ++i) {
    ASSERT_EQ(PositionsOf(answers[i]), PositionsOf(all[i])) << i + 1;
  }
}

INSTANTIATE_TEST_SUITE_P(Frames, ExactResumeTest,
                         ::testing::Values(PlainFrame, LastingFrame),
                         [](const auto& info) {
                           return info.index == 0 ? "Plain" : "Lasting";
                         });

TEST_F(StreamResumeTest, PlainFramesNeedNoContinuation) {
  for (const v1::PoseFrame& answer : Undisturbed(PlainFrame)) {
    ASSERT_THAT(answer.continuation(), IsEmpty());
  }
}

TEST_F(StreamResumeTest, ContinuationsComeAtTheIntervalAskedFor) {
  v1::AttachSession attach = AttachRequest(CreateSession());
  attach.set_continuation_interval(20);
  const auto stream = OpenStream({attach});
  std::vector<v1::PoseFrame> answers;
  Play(
      *stream,
      [](int number) {
        v1::TargetFrame frame = WholeFrame(number);
        frame.mutable_targets(0)->set_weight(0.5);
        return frame;
      },
      1, answers);
  std::vector<int> with_continuation;
  for (const v1::PoseFrame& answer : answers) {
    if (!answer.continuation().empty()) {
      with_continuation.push_back(static_cast<int>(answer.sequence_number()));
    }
  }
  EXPECT_THAT(with_continuation, ElementsAre(1, 21, 41));
}

TEST_F(StreamResumeTest, OlderNumbersAreRefusedAfterwards) {
  const std::vector<v1::PoseFrame> all = Undisturbed(PlainFrame);
  const auto stream = OpenStream({ResumeRequest(CreateSession(), all[19])});
  ASSERT_TRUE(stream->SendFrame(PlainFrame(20)));
  ASSERT_TRUE(stream->SendFrame(PlainFrame(21)));
  const std::vector<v1::PoseFrame> answers = stream->NextFrames(2);
  ASSERT_THAT(answers, SizeIs(2));
  EXPECT_EQ(answers[0].status().code(), kInvalidArgument);
  EXPECT_THAT(answers[0].status().message(),
              HasSubstr("want more than 20, got 20"));
  EXPECT_EQ(PositionsOf(answers[1]), PositionsOf(all[20]));
}

TEST_F(StreamResumeTest, GarbageIsRefusedByName) {
  const v1::PoseFrame last = Undisturbed(LastingFrame).back();
  const auto stream = OpenStream();
  const std::string session = CreateSession();
  const auto expect_refused = [&](const v1::PoseFrame& from,
                                  const std::string& field) {
    const StreamEvent event = EventOf(*stream, ResumeRequest(session, from));
    EXPECT_EQ(event.kind(), StreamEvent::KIND_DETACHED);
    EXPECT_EQ(event.status().code(), kInvalidArgument);
    EXPECT_THAT(event.status().message(), HasSubstr(field));
  };
  v1::PoseFrame garbage = last;
  garbage.set_continuation("garbage");
  expect_refused(garbage, "resume_from.continuation: ");
  garbage.set_continuation(std::string(1000, '\0'));
  expect_refused(garbage, "resume_from.continuation: ");
  garbage = last;
  garbage.mutable_continuation()->resize(last.continuation().size() / 2);
  expect_refused(garbage, "resume_from.continuation");
  garbage = last;
  garbage.mutable_pose()->add_positions(0);
  expect_refused(garbage, "resume_from.pose.positions: ");
  garbage.clear_pose();
  expect_refused(garbage, "resume_from.pose.positions: ");
  garbage = last;
  garbage.mutable_pose()->set_positions(
      1, std::numeric_limits<double>::quiet_NaN());
  expect_refused(garbage, "resume_from.pose.positions[1]: ");

  // None of it has left a trace.
  EXPECT_EQ(EventOf(*stream, AttachRequest(session)).kind(),
            StreamEvent::KIND_ATTACHED);
  ASSERT_TRUE(stream->SendFrame(PlainFrame(1)));
  EXPECT_EQ(PositionsOf(*stream->NextFrame()),
            PositionsOf(Undisturbed(PlainFrame).front()));
}

TEST_F(StreamResumeTest, GarbageDoesNotTakeTheSessionFromItsDriver) {
  const std::string session = CreateSession();
  const auto driver = OpenStream({AttachRequest(session)});
  ASSERT_TRUE(driver->SendFrame(PlainFrame(1)));
  v1::PoseFrame garbage = *driver->NextFrame();
  garbage.set_continuation("garbage");
  v1::AttachSession attach = ResumeRequest(session, garbage);
  attach.set_take_over(true);
  const auto thief = OpenStream();
  EXPECT_EQ(EventOf(*thief, attach).kind(), StreamEvent::KIND_DETACHED);
  ASSERT_TRUE(driver->SendFrame(PlainFrame(2)));
  EXPECT_EQ(driver->NextFrame()->status().code(), 0);
}

// Whatever is done to the bytes, they are refused or they make a session that
// works.
TEST_F(StreamResumeTest, DamagedContinuationsDoNoHarm) {
  const v1::PoseFrame last = Undisturbed(LastingFrame).back();
  const int size = static_cast<int>(last.continuation().size());
  testing::Random random(1);
  const auto stream = OpenStream();
  const std::string session = CreateSession();
  int refused = 0;
  constexpr int kTrials = 300;
  for (int i = 0; i < kTrials; ++i) {
    v1::PoseFrame damaged = last;
    std::string& bytes = *damaged.mutable_continuation();
    bytes[testing::UniformIndex(random, size)] ^=
        static_cast<char>(1 << testing::UniformIndex(random, 8));
    if (i % 3 == 0) bytes.resize(testing::UniformIndex(random, size));
    v1::StreamingSolveRequest request;
    *request.add_attach() = ResumeRequest(session, damaged);
    *request.add_frames() = PlainFrame(kFrames + 1);
    request.add_detach(0);
    ASSERT_TRUE(stream->Send(request));
    const auto attached = stream->NextNews();
    const auto answer = stream->NextFrame();
    const auto detached = stream->NextNews();
    ASSERT_TRUE(attached && answer && detached) << i;
    if (attached->kind() == StreamEvent::KIND_DETACHED) {
      ++refused;
      EXPECT_EQ(attached->status().code(), kInvalidArgument);
      EXPECT_EQ(answer->status().code(), kInvalidArgument);
    } else if (answer->status().code() == 0) {
      for (double number : answer->pose().positions()) {
        ASSERT_TRUE(std::isfinite(number)) << i;
      }
    }
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, kTrials);
}

TEST_F(StreamResumeTest, AcrossInstructionSetsIsSaidToBeInexact) {
  const auto info = Call(&v1::KinematicsService::Stub::GetServerInfo,
                         v1::GetServerInfoRequest());
  ASSERT_TRUE(info.ok()) << info.status();
  if (info->instruction_set() == "baseline") {
    GTEST_SKIP() << "this processor has no other level than baseline";
  }
  ServerProcess other(GELENKD, {"--isa", "baseline", "--log-level", "error"});
  ASSERT_EQ(other.Start(), absl::OkStatus());
  client::Connection connection(other.target());
  ASSERT_TRUE(connection
                  .Call(&v1::KinematicsService::Stub::CreateSkeleton,
                        testing::ArmSkeletonRequest())
                  .ok());
  ASSERT_TRUE(connection
                  .Call(&v1::SessionService::Stub::CreateSession,
                        testing::ArmSessionRequest("here"))
                  .ok());
  const std::vector<v1::PoseFrame> all = Undisturbed(LastingFrame);
  SolveStream stream(connection.sessions());
  const StreamEvent event =
      EventOf(stream, ResumeRequest("sessions/here", all[29]));
  EXPECT_EQ(event.kind(), StreamEvent::KIND_ATTACHED);
  EXPECT_EQ(event.sequence_number(), 30);
  EXPECT_EQ(event.status().code(), kFailedPrecondition);
  EXPECT_THAT(event.status().message(), HasSubstr("not exact"));
  EXPECT_THAT(event.status().message(), HasSubstr("baseline"));
  std::vector<v1::PoseFrame> answers(all.begin(), all.begin() + 30);
  Play(stream, LastingFrame, 31, answers);
  // Round-off apart, the same movement.
  for (int i = 30; i < kFrames; ++i) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(answers[i].pose().positions(j), all[i].pose().positions(j),
                  1e-3);
    }
  }
}

}  // namespace
}  // namespace gelenk
