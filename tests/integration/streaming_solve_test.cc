// Frames in, frames out, over the wire: slots, batches, both frame policies,
// what an answer carries, and events.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tests/integration/service_test.h"

namespace gelenk {
namespace {

using testing::ArmSessionRequest;
using testing::AttachRequest;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kAimGoal;
using testing::ReachFrame;
using ::testing::SizeIs;
using testing::SolveStream;
using testing::WholeFrame;
using v1::StreamEvent;

// Round-off of a pose that is solved to the default tolerance from two sides.
constexpr double kSameSolution = 1e-9;

using Positions = std::vector<double>;

Positions PositionsOf(const v1::PoseFrame& frame) {
  return {frame.pose().positions().begin(), frame.pose().positions().end()};
}

std::vector<int64_t> SequenceNumbersOf(
    const std::vector<v1::PoseFrame>& frames) {
  std::vector<int64_t> numbers;
  for (const v1::PoseFrame& frame : frames) {
    numbers.push_back(frame.sequence_number());
  }
  return numbers;
}

class StreamingSolveTest : public ServiceTest {
 protected:
  static void SetUpTestSuite() { StartServer({"--heartbeat", "300ms"}); }

  // Sessions that may share a stream.
  static std::vector<v1::AttachSession> AttachRequests(int count) {
    std::vector<v1::AttachSession> requests;
    for (int i = 0; i < count; ++i) {
      v1::CreateSessionRequest request = ArmSessionRequest();
      request.mutable_session()->set_affinity_key("crew");
      requests.push_back(AttachRequest(CreateSession(request)));
    }
    return requests;
  }
};

TEST_F(StreamingSolveTest, AttachIsAnswered) {
  const std::string session = CreateSession();
  const auto stream = OpenStream();
  v1::AttachSession attach = AttachRequest(session);
  attach.set_slot(7);
  ASSERT_TRUE(stream->Attach(attach));
  const auto event = stream->NextNews();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind(), StreamEvent::KIND_ATTACHED);
  EXPECT_EQ(event->slot(), 7);
  EXPECT_EQ(event->sequence_number(), 0);
  EXPECT_EQ(event->status().code(), 0);
}

TEST_F(StreamingSolveTest, AnAnswerCarriesWhatTheFrameSaid) {
  const auto stream = OpenStream(AttachRequests(1));
  v1::TargetFrame frame = ReachFrame(41, 0.7, 0.4);
  frame.mutable_capture_time()->set_seconds(12);
  frame.mutable_capture_time()->set_nanos(345);
  ASSERT_TRUE(stream->SendFrame(frame));
  const auto answer = stream->NextFrame();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->slot(), 0);
  EXPECT_EQ(answer->sequence_number(), 41);
  EXPECT_EQ(answer->capture_time().seconds(), 12);
  EXPECT_EQ(answer->capture_time().nanos(), 345);
  EXPECT_EQ(answer->status().code(), 0);
  EXPECT_EQ(answer->merged_frame_count(), 0);
  EXPECT_THAT(answer->pose().positions(), SizeIs(3));
  EXPECT_EQ(answer->report().outcome(), v1::SolveReport::OUTCOME_CONVERGED);
  EXPECT_THAT(answer->report().position_errors_m(), SizeIs(2));
  EXPECT_THAT(answer->report().rotation_errors_rad(), SizeIs(2));
  EXPECT_FALSE(answer->has_joint_frames());
  EXPECT_TRUE(answer->has_server_duration());
}

TEST_F(StreamingSolveTest, JointFramesComeWhenAskedFor) {
  std::vector<v1::AttachSession> attach = AttachRequests(1);
  attach[0].set_include_joint_frames(true);
  const auto stream = OpenStream(attach);
  ASSERT_TRUE(stream->SendFrame(WholeFrame(1)));
  const auto answer = stream->NextFrame();
  ASSERT_TRUE(answer);
  EXPECT_THAT(answer->joint_frames().world_translations(), SizeIs(3 * 3));
  EXPECT_THAT(answer->joint_frames().world_rotations(), SizeIs(3 * 4));
}

TEST_F(StreamingSolveTest, WholeReportsComeAtTheIntervalAskedFor) {
  std::vector<v1::AttachSession> attach = AttachRequests(1);
  attach[0].set_report_interval(3);
  const auto stream = OpenStream(attach);
  for (int i = 1; i <= 7; ++i) ASSERT_TRUE(stream->SendFrame(WholeFrame(i)));
  std::vector<bool> whole;
  for (const v1::PoseFrame& answer : stream->NextFrames(7)) {
    EXPECT_EQ(answer.report().outcome(), v1::SolveReport::OUTCOME_CONVERGED);
    whole.push_back(answer.report().method() != v1::SOLVER_METHOD_UNSPECIFIED);
  }
  EXPECT_THAT(whole, ElementsAre(true, false, false, true, false, false, true));
}

// Sessions on one stream do not touch each other.
TEST_F(StreamingSolveTest, SlotsAreAnsweredAsIfTheyWereAlone) {
  constexpr int kSlots = 5;
  constexpr int kFrames = 40;
  const auto together = OpenStream(AttachRequests(kSlots));
  for (int i = 1; i <= kFrames; ++i) {
    for (int slot = 0; slot < kSlots; ++slot) {
      ASSERT_TRUE(together->SendFrame(WholeFrame(i * (slot + 1), slot)));
    }
  }
  std::map<int, std::vector<v1::PoseFrame>> answers;
  for (const v1::PoseFrame& answer : together->NextFrames(kSlots * kFrames)) {
    EXPECT_EQ(answer.status().code(), 0);
    answers[answer.slot()].push_back(answer);
  }
  for (int slot = 0; slot < kSlots; ++slot) {
    ASSERT_THAT(answers[slot], SizeIs(kFrames));
    const auto alone = OpenStream(AttachRequests(1));
    for (int i = 1; i <= kFrames; ++i) {
      ASSERT_TRUE(alone->SendFrame(WholeFrame(i * (slot + 1))));
      const auto answer = alone->NextFrame();
      ASSERT_TRUE(answer);
      EXPECT_EQ(answers[slot][i - 1].sequence_number(), i * (slot + 1));
      EXPECT_EQ(PositionsOf(answers[slot][i - 1]), PositionsOf(*answer));
    }
  }
}

TEST_F(StreamingSolveTest, DetachFreesSlotAndSession) {
  const std::vector<v1::AttachSession> attach = AttachRequests(2);
  const auto stream = OpenStream(attach);
  ASSERT_TRUE(stream->SendFrame(WholeFrame(5, 1)));
  v1::StreamingSolveRequest request;
  request.add_detach(1);
  ASSERT_TRUE(stream->Send(request));
  const auto event = stream->NextNews();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind(), StreamEvent::KIND_DETACHED);
  EXPECT_EQ(event->slot(), 1);
  EXPECT_EQ(event->sequence_number(), 5);
  EXPECT_EQ(event->status().code(), 0);

  ASSERT_TRUE(stream->SendFrame(WholeFrame(6, 1)));
  ASSERT_TRUE(stream->SendFrame(WholeFrame(1, 0)));
  const std::vector<v1::PoseFrame> answers = stream->NextFrames(3);
  ASSERT_THAT(SequenceNumbersOf(answers), ElementsAre(5, 6, 1));
  EXPECT_EQ(answers[1].status().code(), 3);
  EXPECT_THAT(answers[1].status().message(), HasSubstr("slot 1"));
  EXPECT_EQ(answers[2].status().code(), 0);

  const auto other = OpenStream({attach[1]});
  ASSERT_TRUE(other->SendFrame(WholeFrame(6)));
  EXPECT_EQ(other->NextFrame()->status().code(), 0);
}

TEST_F(StreamingSolveTest, DetachOfAnEmptySlotIsAnError) {
  const auto stream = OpenStream(AttachRequests(1));
  v1::StreamingSolveRequest request;
  request.add_detach(3);
  ASSERT_TRUE(stream->Send(request));
  const auto event = stream->NextNews();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind(), StreamEvent::KIND_DETACHED);
  EXPECT_EQ(event->slot(), 3);
  EXPECT_EQ(event->status().code(), 3);
  EXPECT_THAT(event->status().message(), HasSubstr("slot 3"));
}

TEST_F(StreamingSolveTest, AttachToAUsedSlotReplacesItsSession) {
  const std::vector<v1::AttachSession> attach = AttachRequests(2);
  const auto stream = OpenStream({attach[0]});
  ASSERT_TRUE(stream->Attach(attach[1]));
  EXPECT_EQ(stream->NextNews()->kind(), StreamEvent::KIND_ATTACHED);
  ASSERT_TRUE(stream->SendFrame(WholeFrame(1)));
  EXPECT_EQ(stream->NextFrame()->status().code(), 0);
  // The first one has no driver any more.
  EXPECT_TRUE(OpenStream({attach[0]})->SendFrame(WholeFrame(1)));
}

TEST_F(StreamingSolveTest, OneMessageMayAttachSolveAndDetach) {
  v1::StreamingSolveRequest request;
  *request.add_attach() = AttachRequests(1)[0];
  *request.add_frames() = WholeFrame(1);
  *request.add_frames() = WholeFrame(2);
  request.add_detach(0);
  const auto stream = OpenStream();
  ASSERT_TRUE(stream->Send(request));
  EXPECT_THAT(SequenceNumbersOf(stream->NextFrames(2)), ElementsAre(1, 2));
  EXPECT_EQ(stream->NextNews()->kind(), StreamEvent::KIND_ATTACHED);
  EXPECT_EQ(stream->NextNews()->kind(), StreamEvent::KIND_DETACHED);
}

TEST_F(StreamingSolveTest, WhatWasSentBeforeTheHalfCloseIsAnswered) {
  const auto stream = OpenStream(AttachRequests(1));
  for (int i = 1; i <= 100; ++i) ASSERT_TRUE(stream->SendFrame(WholeFrame(i)));
  stream->HalfClose();
  const std::vector<v1::PoseFrame> answers = stream->NextFrames(101);
  ASSERT_THAT(answers, SizeIs(100));
  EXPECT_EQ(answers.back().sequence_number(), 100);
  EXPECT_EQ(stream->Finish(), absl::OkStatus());
}

class BatchTest : public StreamingSolveTest,
                  public ::testing::WithParamInterface<int> {};

TEST_P(BatchTest, EveryFrameOfAMessageIsAnsweredInOrder) {
  constexpr int kFrames = 1000;
  const int batch = GetParam();
  const auto stream = OpenStream(AttachRequests(2));
  v1::StreamingSolveRequest request;
  std::vector<v1::PoseFrame> answers;
  for (int i = 1; i <= kFrames; ++i) {
    *request.add_frames() = WholeFrame((i + 1) / 2, i % 2);
    if (request.frames_size() < batch && i < kFrames) continue;
    ASSERT_TRUE(stream->Send(request));
    request.Clear();
  }
  std::map<int, int64_t> newest;
  for (const v1::PoseFrame& answer : stream->NextFrames(kFrames)) {
    EXPECT_EQ(answer.status().code(), 0) << answer.status().message();
    EXPECT_EQ(answer.sequence_number(), ++newest[answer.slot()]);
    EXPECT_EQ(answer.merged_frame_count(), 0);
  }
  EXPECT_EQ(newest[0], kFrames / 2);
  EXPECT_EQ(newest[1], kFrames / 2);
}

INSTANTIATE_TEST_SUITE_P(Sizes, BatchTest,
                         ::testing::Values(1, 2, 7, 64, 65, 1000));

TEST_F(StreamingSolveTest, LatestWinsAnswersABatchOnce) {
  std::vector<v1::AttachSession> attach = AttachRequests(2);
  attach[0].set_frame_policy(v1::FRAME_POLICY_LATEST_WINS);
  // What nobody chose.
  attach[1].set_frame_policy(v1::FRAME_POLICY_UNSPECIFIED);
  const auto stream = OpenStream(attach);
  v1::StreamingSolveRequest request;
  for (int i = 1; i <= 100; ++i) {
    *request.add_frames() = WholeFrame(i, 0);
    *request.add_frames() = WholeFrame(2 * i, 1);
  }
  ASSERT_TRUE(stream->Send(request));
  std::map<int, v1::PoseFrame> answers;
  for (v1::PoseFrame& answer : stream->NextFrames(2)) {
    answers[answer.slot()] = answer;
  }
  ASSERT_THAT(answers, SizeIs(2));
  EXPECT_EQ(answers[0].sequence_number(), 100);
  EXPECT_EQ(answers[0].merged_frame_count(), 99);
  EXPECT_EQ(answers[1].sequence_number(), 200);
  EXPECT_EQ(answers[1].merged_frame_count(), 99);
}

TEST_F(StreamingSolveTest, LatestWinsMergesGoalsOfDifferentFrames) {
  std::vector<v1::AttachSession> attach = AttachRequests(2);
  attach[0].set_frame_policy(v1::FRAME_POLICY_LATEST_WINS);
  const auto stream = OpenStream(attach);
  const v1::TargetFrame whole = WholeFrame(1);
  v1::TargetFrame only_reach = whole;
  only_reach.mutable_targets()->DeleteSubrange(1, 1);
  v1::TargetFrame only_aim = whole;
  only_aim.mutable_targets()->DeleteSubrange(0, 1);
  only_aim.set_sequence_number(2);
  v1::TargetFrame at_once = whole;
  at_once.set_slot(1);
  v1::StreamingSolveRequest request;
  *request.add_frames() = only_reach;
  *request.add_frames() = only_aim;
  *request.add_frames() = at_once;
  ASSERT_TRUE(stream->Send(request));
  std::map<int, v1::PoseFrame> answers;
  for (v1::PoseFrame& answer : stream->NextFrames(2)) {
    answers[answer.slot()] = answer;
  }
  EXPECT_EQ(PositionsOf(answers[0]), PositionsOf(answers[1]));
}

TEST_F(StreamingSolveTest, LatestWinsCountsWhatItMerges) {
  std::vector<v1::AttachSession> attach = AttachRequests(1);
  attach[0].set_frame_policy(v1::FRAME_POLICY_LATEST_WINS);
  const auto stream = OpenStream(attach);
  constexpr int kFrames = 2000;
  for (int i = 1; i <= kFrames; ++i) {
    ASSERT_TRUE(stream->SendFrame(WholeFrame(i)));
  }
  int64_t newest = 0;
  int64_t counted = 0;
  while (newest < kFrames) {
    const auto answer = stream->NextFrame();
    ASSERT_TRUE(answer);
    EXPECT_GT(answer->sequence_number(), newest);
    newest = answer->sequence_number();
    counted += 1 + answer->merged_frame_count();
    EXPECT_EQ(counted, newest);
  }
}

TEST_F(StreamingSolveTest, EveryFrameHoldsTheSenderAndLosesNothing) {
  const auto stream = OpenStream(AttachRequests(1));
  // Some 100 MB, more than all buffers on the way. Nobody reads: at some point
  // the server stops reading, too.
  constexpr int kMost = 1000000;
  int sent = 0;
  while (sent < kMost) {
    v1::StreamingSolveRequest request;
    for (int i = 0; i < 1000; ++i) *request.add_frames() = WholeFrame(++sent);
    if (!stream->Send(request, absl::Milliseconds(500))) break;
  }
  ASSERT_LT(sent, kMost) << "nothing held the sender";
  const std::vector<v1::PoseFrame> answers = stream->NextFrames(sent);
  ASSERT_THAT(answers, SizeIs(sent));
  for (int i = 0; i < sent; ++i) {
    ASSERT_EQ(answers[i].sequence_number(), i + 1);
    ASSERT_EQ(answers[i].status().code(), 0);
  }
}

TEST_F(StreamingSolveTest, SilenceIsHeartbeats) {
  const auto stream = OpenStream(AttachRequests(1));
  for (int i = 0; i < 3; ++i) {
    const auto event = stream->NextEvent();
    ASSERT_TRUE(event);
    EXPECT_EQ(event->kind(), StreamEvent::KIND_HEARTBEAT);
    EXPECT_EQ(event->slot(), -1);
  }
  ASSERT_TRUE(stream->SendFrame(WholeFrame(1)));
  EXPECT_EQ(stream->NextFrame()->status().code(), 0);
}

TEST_F(StreamingSolveTest, GoalsThatAFrameDoesNotNameKeepTheirTargets) {
  const auto stream = OpenStream(AttachRequests(2));
  for (int i = 1; i <= 20; ++i) {
    const v1::TargetFrame whole = WholeFrame(i, 0);
    v1::TargetFrame partial = whole;
    partial.set_slot(1);
    v1::TargetFrame repeated = whole;
    // Slot 0 repeats "aim" of the first frame, slot 1 does not name it.
    if (i > 1) {
      *repeated.mutable_targets(1) = WholeFrame(1).targets(1);
      partial.mutable_targets()->DeleteSubrange(1, 1);
    }
    ASSERT_TRUE(stream->SendFrame(repeated));
    ASSERT_TRUE(stream->SendFrame(partial));
    const std::vector<v1::PoseFrame> answers = stream->NextFrames(2);
    ASSERT_THAT(answers, SizeIs(2));
    EXPECT_EQ(PositionsOf(answers[0]), PositionsOf(answers[1])) << i;
  }
}

TEST_F(StreamingSolveTest, AnActorThatMovesTakesItsPoseAlong) {
  std::vector<v1::AttachSession> attach = AttachRequests(2);
  attach[1].set_include_joint_frames(true);
  const auto stream = OpenStream(attach);
  for (int i = 1; i <= 10; ++i) {
    // Slot 1: actor and target both 10 i further along X and 3 i up.
    v1::TargetFrame moved = ReachFrame(i, 0.8 + 10 * i, 0.1 * i + 3 * i, 1);
    auto* place = moved.mutable_world_from_skeleton()->mutable_translation();
    place->set_x(10 * i);
    place->set_y(3 * i);
    ASSERT_TRUE(stream->SendFrame(ReachFrame(i, 0.8, 0.1 * i, 0)));
    ASSERT_TRUE(stream->SendFrame(moved));
    const std::vector<v1::PoseFrame> answers = stream->NextFrames(2);
    ASSERT_THAT(answers, SizeIs(2));
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(answers[0].pose().positions(j),
                  answers[1].pose().positions(j), kSameSolution);
    }
    EXPECT_NEAR(answers[1].joint_frames().world_translations(0), 10 * i, 1e-5);
    EXPECT_NEAR(answers[1].joint_frames().world_translations(1), 3 * i, 1e-5);
  }
}

TEST_F(StreamingSolveTest, APlaceStaysWhereAFramePutIt) {
  const auto stream = OpenStream(AttachRequests(2));
  v1::TargetFrame moving = ReachFrame(1, 5.8, 0.1, 0);
  moving.mutable_world_from_skeleton()->mutable_translation()->set_x(5);
  ASSERT_TRUE(stream->SendFrame(moving));
  ASSERT_TRUE(stream->SendFrame(ReachFrame(2, 5.9, 0.3, 0)));
  const std::vector<v1::PoseFrame> answers = stream->NextFrames(2);
  ASSERT_THAT(answers, SizeIs(2));
  EXPECT_EQ(answers[1].report().outcome(), v1::SolveReport::OUTCOME_CONVERGED);
}

TEST_F(StreamingSolveTest, APatchedGoalCanBeNamedInTheSameFrame) {
  const auto stream = OpenStream(AttachRequests(1));
  v1::TargetFrame frame = ReachFrame(1, 0.7, 0.2);
  v1::Goal* goal = frame.mutable_goal_patch()->add_goals();
  goal->set_goal_id("elbow");
  goal->set_weight(0.5);
  goal->mutable_position()->set_end_effector_id("j2");
  frame.mutable_goal_patch()->add_removed_goal_ids("aim");
  v1::GoalTarget* target = frame.add_targets();
  target->set_goal_index(kAimGoal);  // "elbow" is there now
  target->mutable_world_position()->set_x(0.8);
  ASSERT_TRUE(stream->SendFrame(frame));
  ASSERT_TRUE(stream->SendFrame(ReachFrame(2, 0.7, 0.3)));
  const std::vector<v1::PoseFrame> answers = stream->NextFrames(2);
  ASSERT_THAT(answers, SizeIs(2));
  for (const v1::PoseFrame& answer : answers) {
    EXPECT_EQ(answer.status().code(), 0) << answer.status().message();
    ASSERT_THAT(answer.report().position_errors_m(), SizeIs(2));
    // A point, not a rotation, and told to the client for its next attach.
    EXPECT_EQ(answer.report().rotation_errors_rad(1), 0);
    EXPECT_FALSE(answer.continuation().empty());
  }
}

}  // namespace
}  // namespace gelenk
