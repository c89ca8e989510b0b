#include "gelenk/client/slot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace gelenk::client {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Phase = Slot::Phase;

constexpr int kWindow = 4;
constexpr int kMaxFrames = 100;
const SteadyTime kStart{std::chrono::seconds(1000)};

SessionSpec OneGoalSpec(v1::FramePolicy policy) {
  SessionSpec spec;
  spec.skeleton.set_skeleton_id("arm");
  spec.skeleton.set_request_id("create-arm");
  spec.skeleton.mutable_skeleton();
  spec.session.set_session_id("left");
  spec.session.set_request_id("create-left");
  v1::Goal* goal = spec.session.mutable_session()->add_goals();
  goal->set_goal_id("hand");
  goal->mutable_position()->mutable_world_position()->set_x(0.5);
  spec.frame_policy = policy;
  return spec;
}

v1::TargetFrame Frame(int64_t sequence_number, double x) {
  v1::TargetFrame frame;
  frame.set_sequence_number(sequence_number);
  frame.add_targets()->mutable_world_position()->set_x(x);
  return frame;
}

v1::TargetFrame PatchFrame(int64_t sequence_number) {
  v1::TargetFrame frame;
  frame.set_sequence_number(sequence_number);
  v1::Goal* goal = frame.mutable_goal_patch()->add_goals();
  goal->set_goal_id("elbow");
  goal->mutable_position();
  return frame;
}

v1::PoseFrame Answer(int64_t sequence_number, double q) {
  v1::PoseFrame answer;
  answer.set_sequence_number(sequence_number);
  answer.mutable_pose()->add_positions(q);
  return answer;
}

v1::PoseFrame Refusal(int64_t sequence_number, double q) {
  v1::PoseFrame answer = Answer(sequence_number, q);
  answer.mutable_status()->set_code(3);
  return answer;
}

v1::StreamEvent Event(int64_t sequence_number) {
  v1::StreamEvent event;
  event.set_sequence_number(sequence_number);
  return event;
}

v1::StreamEvent Detached(absl::StatusCode code) {
  v1::StreamEvent event;
  event.mutable_status()->set_code(static_cast<int>(code));
  event.mutable_status()->set_message("why");
  return event;
}

class SlotTest : public ::testing::Test {
 protected:
  // Created and attached.
  Slot Attached(v1::FramePolicy policy) {
    Slot slot(0, OneGoalSpec(policy));
    slot.SetCreated();
    Attach(slot, 0);
    return slot;
  }

  v1::AttachSession Attach(Slot& slot, int64_t newest) {
    v1::AttachSession request;
    slot.Attach(&request);
    EXPECT_TRUE(slot.OnAttached(Event(newest), &statistics_).ok());
    return request;
  }

  void Push(Slot& slot, const v1::TargetFrame& frame) {
    ASSERT_TRUE(slot.CheckNumber(frame.sequence_number()).ok());
    ASSERT_TRUE(slot.HasRoom(frame, kWindow));
    slot.Push(frame, kStart, &statistics_);
  }

  v1::StreamingSolveRequest Send(Slot& slot) {
    v1::StreamingSolveRequest request;
    slot.Send(kMaxFrames, kWindow, &request, &statistics_);
    return request;
  }

  std::vector<int64_t> SentNumbers(Slot& slot) {
    std::vector<int64_t> numbers;
    const v1::StreamingSolveRequest request = Send(slot);
    for (const v1::TargetFrame& frame : request.frames()) {
      numbers.push_back(frame.sequence_number());
    }
    return numbers;
  }

  bool Settle(Slot& slot, const v1::PoseFrame& answer) {
    return slot.Settle(answer, kStart + std::chrono::milliseconds(3),
                       &statistics_);
  }

  // Answers 1 and 2, sends 3 and 4, then loses the connection.
  void LoseAfterTwo(Slot& slot, const std::string& continuation) {
    for (int i = 1; i <= 2; ++i) {
      Push(slot, Frame(i, i));
      Send(slot);
      v1::PoseFrame answer = Answer(i, 10 * i);
      answer.set_continuation(continuation);
      ASSERT_TRUE(Settle(slot, answer));
    }
    Push(slot, Frame(3, 3));
    Push(slot, Frame(4, 4));
    Send(slot);
    slot.Rewind(&statistics_);
  }

  StreamStatistics statistics_;
};

TEST_F(SlotTest, FirstCreationIsWhatTheCallerGave) {
  Slot slot(0, OneGoalSpec(v1::FRAME_POLICY_EVERY_FRAME));
  EXPECT_EQ(slot.phase(), Phase::kAbsent);
  const Creation creation = slot.NextCreation();
  EXPECT_EQ(creation.session.request_id(), "create-left");
  EXPECT_EQ(creation.skeleton->request_id(), "create-arm");
  EXPECT_EQ(creation.affinity_key, "left");
  EXPECT_FALSE(creation.again);
  EXPECT_FALSE(creation.replaces);
}

TEST_F(SlotTest, SendsInOrderUpToTheWindow) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  for (int i = 1; i <= 4; ++i) Push(slot, Frame(i, i));
  EXPECT_FALSE(slot.HasRoom(Frame(5, 5), kWindow));
  EXPECT_THAT(SentNumbers(slot), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(SentNumbers(slot), IsEmpty());
  EXPECT_TRUE(Settle(slot, Answer(1, 0)));
  EXPECT_TRUE(slot.HasRoom(Frame(5, 5), kWindow));
  EXPECT_EQ(slot.unanswered_count(), 3);
  EXPECT_EQ(statistics_.round_trips.Quantile(0), absl::Milliseconds(3));
}

TEST_F(SlotTest, RefusesNumbersThatDoNotRise) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  Push(slot, Frame(7, 0));
  EXPECT_TRUE(absl::IsInvalidArgument(slot.CheckNumber(7)));
  EXPECT_TRUE(absl::IsInvalidArgument(slot.CheckNumber(-1)));
  EXPECT_TRUE(slot.CheckNumber(8).ok());
}

TEST_F(SlotTest, FirstAttachLearnsTheNumbersOfTheSession) {
  Slot slot(0, OneGoalSpec(v1::FRAME_POLICY_EVERY_FRAME));
  slot.SetCreated();
  Attach(slot, 41);
  EXPECT_FALSE(slot.CheckNumber(41).ok());
  EXPECT_TRUE(slot.CheckNumber(42).ok());
}

TEST_F(SlotTest, AnswersCountOnce) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  Push(slot, Frame(1, 1));
  Send(slot);
  EXPECT_TRUE(Settle(slot, Answer(1, 0)));
  EXPECT_FALSE(Settle(slot, Answer(1, 0)));
  EXPECT_EQ(statistics_.answered_frames, 1);
}

TEST_F(SlotTest, GoesOnFromAnAnswerThatNoFrameAskedFor) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  v1::PoseFrame fill = Answer(1, 15);
  fill.mutable_timing()->set_filled(true);
  EXPECT_FALSE(slot.TakeFill(fill)) << "before any answer";
  Push(slot, Frame(1, 1));
  Push(slot, Frame(2, 2));
  Send(slot);
  EXPECT_TRUE(Settle(slot, Answer(1, 10)));
  fill.set_continuation("eased");
  EXPECT_TRUE(slot.TakeFill(fill));
  EXPECT_EQ(slot.unanswered_count(), 1);
  EXPECT_EQ(statistics_.answered_frames, 1);
  slot.Rewind(&statistics_);
  const v1::AttachSession attach = Attach(slot, 1);
  EXPECT_EQ(attach.resume_from().sequence_number(), 1);
  EXPECT_EQ(attach.resume_from().pose().positions(0), 15);
  EXPECT_EQ(attach.resume_from().continuation(), "eased");
  EXPECT_THAT(SentNumbers(slot), ElementsAre(2));
  EXPECT_TRUE(Settle(slot, Answer(2, 20)));
  EXPECT_FALSE(slot.TakeFill(fill)) << "overtaken";
}

TEST_F(SlotTest, ResumesFromTheLastAnswerAndSendsTheRestAgain) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  LoseAfterTwo(slot, "all that there is");
  EXPECT_EQ(slot.phase(), Phase::kDetached);
  const v1::AttachSession attach = Attach(slot, 2);
  EXPECT_EQ(attach.resume_from().sequence_number(), 2);
  EXPECT_EQ(attach.resume_from().pose().positions(0), 20);
  EXPECT_EQ(attach.resume_from().continuation(), "all that there is");
  EXPECT_THAT(SentNumbers(slot), ElementsAre(3, 4));
  EXPECT_EQ(statistics_.resent_frames, 2);
}

TEST_F(SlotTest, WithoutContinuationOneFrameGoesAheadAndSaysEverything) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  LoseAfterTwo(slot, "");
  Push(slot, v1::TargetFrame(Frame(5, 5)));
  Attach(slot, 2);
  EXPECT_THAT(SentNumbers(slot), ElementsAre(3));
  EXPECT_THAT(SentNumbers(slot), IsEmpty());
  // A refused frame has left the goals where they were.
  EXPECT_TRUE(Settle(slot, Refusal(3, 20)));
  EXPECT_THAT(SentNumbers(slot), ElementsAre(4));
  EXPECT_TRUE(Settle(slot, Answer(4, 40)));
  EXPECT_THAT(SentNumbers(slot), ElementsAre(5));
}

TEST_F(SlotTest, FrameAheadNamesGoalsThatItLeftAlone) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  Push(slot, Frame(1, 1));
  Send(slot);
  Settle(slot, Answer(1, 10));
  v1::TargetFrame nothing;
  nothing.set_sequence_number(2);
  Push(slot, nothing);
  Push(slot, Frame(3, 3));
  Send(slot);
  slot.Rewind(&statistics_);
  Attach(slot, 1);
  const v1::StreamingSolveRequest request = Send(slot);
  ASSERT_EQ(request.frames_size(), 1);
  ASSERT_EQ(request.frames(0).targets_size(), 1);
  EXPECT_EQ(request.frames(0).targets(0).world_position().x(), 1);
  EXPECT_FALSE(request.frames(0).targets(0).has_weight());
  EXPECT_FALSE(request.frames(0).has_world_from_skeleton());
}

TEST_F(SlotTest, FrameAheadTakesBackWeightsThatWereMoved) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  Push(slot, Frame(1, 1));
  Send(slot);
  Settle(slot, Answer(1, 10));
  Push(slot, Frame(2, 2));
  v1::TargetFrame heavy = Frame(3, 3);
  heavy.mutable_targets(0)->set_weight(9);
  heavy.mutable_world_from_skeleton()->mutable_translation()->set_z(1);
  Push(slot, heavy);
  Send(slot);
  slot.Rewind(&statistics_);
  Attach(slot, 1);
  const v1::StreamingSolveRequest request = Send(slot);
  ASSERT_EQ(request.frames_size(), 1);
  EXPECT_EQ(request.frames(0).targets(0).weight(), 1);
  ASSERT_TRUE(request.frames(0).has_world_from_skeleton());
  EXPECT_FALSE(request.frames(0).world_from_skeleton().has_translation());
}

TEST_F(SlotTest, RecreatesTheSessionAsOfTheLastAnswer) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  LoseAfterTwo(slot, "");
  v1::AttachSession attach;
  slot.Attach(&attach);
  ASSERT_TRUE(slot.OnDetached(Detached(absl::StatusCode::kNotFound)).ok());
  ASSERT_EQ(slot.phase(), Phase::kAbsent);
  const Creation creation = slot.NextCreation();
  EXPECT_TRUE(creation.again);
  EXPECT_EQ(creation.session.request_id(), "create-left-1");
  EXPECT_EQ(creation.session.session().pose().positions(0), 20);
  EXPECT_EQ(creation.session.session().goals(0).position().world_position().x(),
            2);
  slot.SetCreated();
  EXPECT_EQ(Attach(slot, 2).resume_from().sequence_number(), 2);
}

TEST_F(SlotTest, NothingAnsweredRecreatesExactlyAsFirst) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  Push(slot, Frame(1, 1));
  Send(slot);
  Settle(slot, Refusal(1, 77));
  Push(slot, Frame(2, 2));
  Send(slot);
  slot.Rewind(&statistics_);
  v1::AttachSession attach;
  slot.Attach(&attach);
  EXPECT_FALSE(attach.has_resume_from());
  ASSERT_TRUE(slot.OnDetached(Detached(absl::StatusCode::kNotFound)).ok());
  const Creation creation = slot.NextCreation();
  EXPECT_FALSE(creation.session.session().has_pose());
  EXPECT_EQ(creation.session.session().goals(0).position().world_position().x(),
            0.5);
  slot.SetCreated();
  EXPECT_FALSE(Attach(slot, 0).has_resume_from());
  EXPECT_THAT(SentNumbers(slot), ElementsAre(2));
}

TEST_F(SlotTest, SessionThatSolvedUnheardIsReplaced) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  Push(slot, Frame(1, 1));
  Send(slot);
  slot.Rewind(&statistics_);
  v1::AttachSession attach;
  slot.Attach(&attach);
  EXPECT_TRUE(absl::IsUnavailable(slot.OnAttached(Event(1), &statistics_)));
  EXPECT_EQ(slot.phase(), Phase::kAbsent);
  EXPECT_TRUE(slot.NextCreation().replaces);
}

TEST_F(SlotTest, SessionWithAPatchUnheardIsReplaced) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  Push(slot, Frame(1, 1));
  Send(slot);
  Settle(slot, Answer(1, 10));
  Push(slot, PatchFrame(2));
  Send(slot);
  slot.Rewind(&statistics_);
  v1::AttachSession attach;
  slot.Attach(&attach);
  EXPECT_TRUE(absl::IsUnavailable(slot.OnAttached(Event(1), &statistics_)));
  const Creation creation = slot.NextCreation();
  EXPECT_TRUE(creation.replaces);
  EXPECT_EQ(creation.session.session().goals_size(), 1);
}

TEST_F(SlotTest, LatestWinsMergesWhatWaits) {
  Slot slot = Attached(v1::FRAME_POLICY_LATEST_WINS);
  for (int i = 1; i <= 20; ++i) Push(slot, Frame(i, i));
  const v1::StreamingSolveRequest request = Send(slot);
  ASSERT_EQ(request.frames_size(), 1);
  EXPECT_EQ(request.frames(0).sequence_number(), 20);
  EXPECT_EQ(request.frames(0).targets(0).world_position().x(), 20);
  EXPECT_EQ(statistics_.merged_frames, 19);
}

TEST_F(SlotTest, LatestWinsHasRoomBehindAFullWindow) {
  Slot slot = Attached(v1::FRAME_POLICY_LATEST_WINS);
  for (int i = 1; i <= 10; ++i) {
    Push(slot, Frame(i, i));
    Send(slot);
  }
  EXPECT_EQ(slot.unanswered_count(), kWindow + 1);
  EXPECT_TRUE(Settle(slot, Answer(kWindow, 0)));
  EXPECT_THAT(SentNumbers(slot), ElementsAre(10));
}

TEST_F(SlotTest, LatestWinsBoundsPatches) {
  Slot slot = Attached(v1::FRAME_POLICY_LATEST_WINS);
  for (int i = 1; i <= 2 * kWindow; ++i) Push(slot, PatchFrame(i));
  EXPECT_FALSE(slot.HasRoom(PatchFrame(100), kWindow));
  EXPECT_TRUE(slot.HasRoom(Frame(100, 0), kWindow));
}

TEST_F(SlotTest, LatestWinsResumesWithOneFrame) {
  Slot slot = Attached(v1::FRAME_POLICY_LATEST_WINS);
  LoseAfterTwo(slot, "all that there is");
  Attach(slot, 2);
  EXPECT_THAT(SentNumbers(slot), ElementsAre(4));
}

TEST_F(SlotTest, OneAnswerSettlesAllThatItMerged) {
  Slot slot = Attached(v1::FRAME_POLICY_LATEST_WINS);
  for (int i = 1; i <= 3; ++i) {
    Push(slot, Frame(i, i));
    Send(slot);
  }
  EXPECT_TRUE(Settle(slot, Answer(3, 30)));
  EXPECT_EQ(slot.unanswered_count(), 0);
}

TEST_F(SlotTest, TakenOverEndsForGood) {
  Slot slot = Attached(v1::FRAME_POLICY_EVERY_FRAME);
  EXPECT_TRUE(slot.OnDetached(Detached(absl::StatusCode::kAborted)).ok());
  EXPECT_EQ(slot.phase(), Phase::kEnded);
  EXPECT_TRUE(absl::IsAborted(slot.status()));
  slot.Rewind(&statistics_);
  EXPECT_EQ(slot.phase(), Phase::kEnded);
}

TEST_F(SlotTest, TakesOverOnlyTheFirstTime) {
  SessionSpec spec = OneGoalSpec(v1::FRAME_POLICY_EVERY_FRAME);
  spec.take_over = true;
  Slot slot(0, spec);
  slot.SetCreated();
  EXPECT_TRUE(Attach(slot, 0).take_over());
  slot.Rewind(&statistics_);
  EXPECT_FALSE(Attach(slot, 0).take_over());
}

TEST_F(SlotTest, DrivenSessionIsAnErrorAtFirstAndAReasonToWaitLater) {
  Slot slot(0, OneGoalSpec(v1::FRAME_POLICY_EVERY_FRAME));
  slot.SetCreated();
  v1::AttachSession attach;
  slot.Attach(&attach);
  const v1::StreamEvent driven =
      Detached(absl::StatusCode::kFailedPrecondition);
  Slot later = slot;
  EXPECT_TRUE(slot.OnDetached(driven).ok());
  EXPECT_EQ(slot.phase(), Phase::kEnded);

  EXPECT_TRUE(later.OnAttached(Event(0), &statistics_).ok());
  later.Rewind(&statistics_);
  later.Attach(&attach);
  EXPECT_TRUE(absl::IsUnavailable(later.OnDetached(driven)));
  EXPECT_EQ(later.phase(), Phase::kDetached);
}

TEST_F(SlotTest, CreatedAndNotFoundNeedsAnotherAttempt) {
  Slot slot(0, OneGoalSpec(v1::FRAME_POLICY_EVERY_FRAME));
  slot.SetCreated();
  v1::AttachSession attach;
  slot.Attach(&attach);
  EXPECT_TRUE(absl::IsUnavailable(
      slot.OnDetached(Detached(absl::StatusCode::kNotFound))));
  EXPECT_EQ(slot.phase(), Phase::kAbsent);
}

}  // namespace
}  // namespace gelenk::client
