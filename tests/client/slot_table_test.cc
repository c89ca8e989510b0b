#include "gelenk/client/slot_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"

namespace gelenk::client {
namespace {

using ::testing::ElementsAre;

constexpr int kWindow = 100;
constexpr int kMaxFrames = 4;

std::vector<SessionSpec> Specs(int count) {
  std::vector<SessionSpec> specs(count);
  for (int i = 0; i < count; ++i) {
    specs[i].session.set_session_id(absl::StrCat("session", i));
    specs[i].session.mutable_session();
    specs[i].frame_policy = v1::FRAME_POLICY_EVERY_FRAME;
  }
  return specs;
}

class SlotTableTest : public ::testing::Test {
 protected:
  SlotTableTest() {
    while (Slot* slot = slots_.FindAbsent()) slot->SetCreated();
  }

  void Attach() {
    v1::StreamingSolveRequest request;
    slots_.Write(kMaxFrames, kWindow, &request);
    v1::StreamingSolveResponse response;
    for (const v1::AttachSession& attach : request.attach()) {
      *response.add_events() =
          Event(v1::StreamEvent::KIND_ATTACHED, attach.slot());
    }
    Read(response);
  }

  static v1::StreamEvent Event(v1::StreamEvent::Kind kind, int slot,
                               absl::StatusCode code = {}) {
    v1::StreamEvent event;
    event.set_kind(kind);
    event.set_slot(slot);
    event.mutable_status()->set_code(static_cast<int>(code));
    return event;
  }

  SlotTable::News Read(v1::StreamingSolveResponse response) {
    return slots_.Read(&response, SteadyTime(), &answers_);
  }

  SlotTable::News ReadEvent(const v1::StreamEvent& event) {
    v1::StreamingSolveResponse response;
    *response.add_events() = event;
    return Read(response);
  }

  void Push(int slot, int count) {
    for (int i = 1; i <= count; ++i) {
      v1::TargetFrame frame;
      frame.set_slot(slot);
      frame.set_sequence_number(i);
      slots_.Find(slot)->Push(frame, SteadyTime(), &slots_.statistics());
    }
  }

  SlotTable slots_{Specs(3)};
  std::deque<v1::PoseFrame> answers_;
};

TEST_F(SlotTableTest, FirstMessageAttachesAllSlots) {
  v1::StreamingSolveRequest request;
  EXPECT_TRUE(slots_.Write(kMaxFrames, kWindow, &request));
  ASSERT_EQ(request.attach_size(), 3);
  EXPECT_EQ(request.attach(2).session(), "sessions/session2");
  EXPECT_EQ(request.attach(2).slot(), 2);
  request.Clear();
  EXPECT_FALSE(slots_.Write(kMaxFrames, kWindow, &request));
  EXPECT_FALSE(slots_.AllAttached());
}

TEST_F(SlotTableTest, FramesWaitForTheirAttach) {
  Push(1, 1);
  v1::StreamingSolveRequest request;
  slots_.Write(kMaxFrames, kWindow, &request);
  EXPECT_EQ(request.frames_size(), 0);
  ReadEvent(Event(v1::StreamEvent::KIND_ATTACHED, 1));
  request.Clear();
  EXPECT_TRUE(slots_.Write(kMaxFrames, kWindow, &request));
  EXPECT_EQ(request.frames_size(), 1);
}

TEST_F(SlotTableTest, SlotsTakeTurns) {
  Attach();
  for (int slot : {0, 1, 2}) Push(slot, 6);
  std::vector<int> order;
  v1::StreamingSolveRequest request;
  while (slots_.Write(kMaxFrames, kWindow, &request)) {
    ASSERT_LE(request.frames_size(), kMaxFrames);
    order.push_back(request.frames(0).slot());
    request.Clear();
  }
  // Four each, then two and two in one message, then two.
  EXPECT_THAT(order, ElementsAre(0, 1, 2, 0, 2));
}

TEST_F(SlotTableTest, AnswersOfStrangersAreDropped) {
  Attach();
  v1::StreamingSolveResponse response;
  for (int slot : {-1, 3, 1}) {
    v1::PoseFrame* answer = response.add_frames();
    answer->set_slot(slot);
    answer->set_sequence_number(1);
  }
  EXPECT_TRUE(Read(response).has_answers);
  ASSERT_EQ(answers_.size(), 1);
  EXPECT_EQ(answers_[0].slot(), 1);
}

TEST_F(SlotTableTest, EventsOfTheStream) {
  Attach();
  EXPECT_FALSE(ReadEvent(Event(v1::StreamEvent::KIND_HEARTBEAT, -1)).draining);
  EXPECT_TRUE(ReadEvent(Event(v1::StreamEvent::KIND_DRAINING, -1)).draining);
  const SlotTable::News news = ReadEvent(Event(
      v1::StreamEvent::KIND_CLOSING, -1, absl::StatusCode::kResourceExhausted));
  ASSERT_TRUE(news.closing.has_value());
  EXPECT_TRUE(absl::IsResourceExhausted(*news.closing));
}

TEST_F(SlotTableTest, OneSlotEndsTheOthersGoOn) {
  Attach();
  ReadEvent(
      Event(v1::StreamEvent::KIND_DETACHED, 1, absl::StatusCode::kAborted));
  EXPECT_TRUE(absl::IsAborted(slots_.status()));
  EXPECT_FALSE(slots_.AllEnded());
  slots_.Rewind();
  v1::StreamingSolveRequest request;
  slots_.Write(kMaxFrames, kWindow, &request);
  EXPECT_EQ(request.attach_size(), 2);
}

TEST_F(SlotTableTest, SlotThatNeedsAnotherConnectionSaysSo) {
  v1::StreamingSolveRequest request;
  slots_.Write(kMaxFrames, kWindow, &request);
  const SlotTable::News news = ReadEvent(
      Event(v1::StreamEvent::KIND_DETACHED, 0, absl::StatusCode::kUnavailable));
  ASSERT_TRUE(news.new_attempt.has_value());
  EXPECT_TRUE(absl::IsUnavailable(*news.new_attempt));
}

}  // namespace
}  // namespace gelenk::client
