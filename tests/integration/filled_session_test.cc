// Sessions whose source falls silent, and which fill in what does not come.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/client/connection.h"
#include "gelenk/client/session_stream.h"
#include "tests/integration/follower_test.h"
#include "tests/testing/followed_body.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using testing::ArmSessionRequest;
using testing::AttachRequest;
using testing::Fails;
using ::testing::HasSubstr;
using testing::SolveStream;
using v1::FrameTiming;
using v1::StreamConditioning;

constexpr int kFrames = 20;
constexpr int kFrameMs = 20;
constexpr int kDeadlineExceeded = 4;
constexpr int kOutOfRange = 11;
// No fill is due for so long.
constexpr absl::Duration kSilence = absl::Milliseconds(150);

using Positions = std::vector<double>;

Positions PositionsOf(const v1::PoseFrame& frame) {
  return {frame.pose().positions().begin(), frame.pose().positions().end()};
}

double LargestStep(const v1::PoseFrame& from, const v1::PoseFrame& to) {
  double most = 0;
  for (int i = 0; i < to.pose().positions_size(); ++i) {
    most = std::max(
        most, std::abs(to.pose().positions(i) - from.pose().positions(i)));
  }
  return most;
}

double Seconds(const google::protobuf::Duration& duration) {
  return static_cast<double>(duration.seconds()) + 1e-9 * duration.nanos();
}

void SetTime(int ms, v1::TargetFrame& frame) {
  frame.mutable_capture_time()->set_seconds(ms / 1000);
  frame.mutable_capture_time()->set_nanos(ms % 1000 * 1000000);
}

class FilledSessionTest : public FollowerTest {
 protected:
  static StreamConditioning Filling(StreamConditioning::LatePolicy policy,
                                    int interval_ms = kFrameMs) {
    StreamConditioning conditioning;
    conditioning.set_late_policy(policy);
    conditioning.mutable_fill_interval()->set_nanos(interval_ms * 1000000);
    conditioning.mutable_extrapolation_limit()->set_nanos(60'000'000);
    conditioning.mutable_ease_duration()->set_nanos(100'000'000);
    return conditioning;
  }

  static v1::TargetFrame ClipFrame(int number) {
    v1::TargetFrame frame = testing::SourceFrame(Clip(), number);
    SetTime(number * kFrameMs, frame);
    return frame;
  }

  // The first kFrames of the clip, and their answers.
  static std::vector<v1::PoseFrame> Play(SolveStream& stream) {
    v1::StreamingSolveRequest request;
    for (int i = 1; i <= kFrames; ++i) *request.add_frames() = ClipFrame(i);
    EXPECT_TRUE(stream.Send(request));
    return stream.NextFrames(kFrames);
  }

  // What comes by itself.
  static std::vector<v1::PoseFrame> Fills(SolveStream& stream) {
    std::vector<v1::PoseFrame> fills;
    while (auto fill = stream.NextFrame(fills.empty() ? testing::kPatience
                                                      : kSilence)) {
      fills.push_back(*std::move(fill));
    }
    return fills;
  }
};

TEST_F(FilledSessionTest, ASilentSourceEasesToRest) {
  const std::string session = CreateSession(
      Follower(Filling(StreamConditioning::LATE_POLICY_EXTRAPOLATE)));
  const auto stream = OpenStream({AttachRequest(session)});
  v1::PoseFrame before = Play(*stream).back();
  EXPECT_FALSE(before.timing().filled());
  const auto fills = Fills(*stream);
  // 160 ms and a second to settle in, in pieces of 20 ms at least.
  ASSERT_GE(fills.size(), 2u);
  EXPECT_LE(fills.size(), 60u);
  EXPECT_EQ(fills.back().timing().source(), FrameTiming::SOURCE_EASED);
  for (const v1::PoseFrame& fill : fills) {
    EXPECT_TRUE(fill.timing().filled());
    EXPECT_EQ(fill.status().code(), 0) << fill.status().message();
    EXPECT_EQ(fill.sequence_number(), kFrames);
    EXPECT_EQ(fill.merged_frame_count(), 0);
    EXPECT_GT(Seconds(fill.capture_time()), Seconds(before.capture_time()));
    EXPECT_NE(fill.timing().source(), FrameTiming::SOURCE_UNSPECIFIED);
    EXPECT_FALSE(fill.continuation().empty());
    before = fill;
  }
  EXPECT_LE(LargestStep(*(fills.end() - 2), fills.back()), 0.02);

  // A viewer who comes now sees it at rest.
  grpc::ClientContext context;
  v1::WatchSessionRequest request;
  request.set_name(session);
  const auto viewer = connection().sessions().WatchSession(&context, request);
  v1::WatchSessionResponse seen;
  ASSERT_TRUE(viewer->Read(&seen));
  EXPECT_EQ(
      Positions(seen.pose().positions().begin(), seen.pose().positions().end()),
      PositionsOf(fills.back()));
  context.TryCancel();
  viewer->Finish();

  // And goes on without a jump.
  v1::TargetFrame next = ClipFrame(kFrames + 1);
  SetTime(60000, next);
  ASSERT_TRUE(stream->SendFrame(next));
  const auto answer = stream->NextFrame();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->sequence_number(), kFrames + 1);
  EXPECT_FALSE(answer->timing().filled());
  EXPECT_EQ(answer->status().code(), 0) << answer->status().message();
  EXPECT_LT(LargestStep(fills.back(), *answer), 0.2);
}

TEST_F(FilledSessionTest, APoseIsHeldOnce) {
  v1::CreateSessionRequest arm = ArmSessionRequest();
  *arm.mutable_session()->mutable_conditioning() =
      Filling(StreamConditioning::LATE_POLICY_HOLD);
  for (v1::FramePolicy policy :
       {v1::FRAME_POLICY_EVERY_FRAME, v1::FRAME_POLICY_LATEST_WINS}) {
    v1::AttachSession attach = AttachRequest(CreateSession(arm));
    attach.set_frame_policy(policy);
    const auto stream = OpenStream({attach});
    v1::TargetFrame frame = testing::ReachFrame(1, 0.9, 0.5);
    SetTime(kFrameMs, frame);
    ASSERT_TRUE(stream->SendFrame(frame));
    ASSERT_TRUE(stream->NextFrame());
    const auto fills = Fills(*stream);
    ASSERT_GE(fills.size(), 1u);
    // The solver may still have had a micrometre to go.
    EXPECT_LE(fills.size(), 3u);
    EXPECT_EQ(fills.back().timing().source(), FrameTiming::SOURCE_HELD);
    EXPECT_TRUE(fills.back().timing().filled());
  }
}

TEST_F(FilledSessionTest, ADroppedFrameIsToldOnce) {
  const auto stream = OpenStream({AttachRequest(CreateSession(
      Follower(Filling(StreamConditioning::LATE_POLICY_DROP, 60))))});
  const v1::PoseFrame last = Play(*stream).back();
  const auto fills = Fills(*stream);
  ASSERT_EQ(fills.size(), 1u);
  EXPECT_EQ(fills[0].status().code(), kDeadlineExceeded);
  EXPECT_EQ(PositionsOf(fills[0]), PositionsOf(last));
}

TEST_F(FilledSessionTest, WithoutTheOptionNothingComesByItself) {
  StreamConditioning conditioning =
      Filling(StreamConditioning::LATE_POLICY_EXTRAPOLATE);
  conditioning.clear_fill_interval();
  const auto stream =
      OpenStream({AttachRequest(CreateSession(Follower(conditioning)))});
  Play(*stream);
  EXPECT_FALSE(stream->NextFrame(kSilence));
}

TEST_F(FilledSessionTest, FramesThatWereFilledInForAreLate) {
  const auto stream = OpenStream({AttachRequest(
      CreateSession(Follower(Filling(StreamConditioning::LATE_POLICY_HOLD))))});
  Play(*stream);
  const auto fills = Fills(*stream);
  ASSERT_FALSE(fills.empty());
  // Captured before what was filled in.
  v1::TargetFrame late = ClipFrame(kFrames + 1);
  late.mutable_capture_time()->set_seconds(0);
  late.mutable_capture_time()->set_nanos(kFrames * kFrameMs * 1000000 + 1000);
  ASSERT_TRUE(stream->SendFrame(late));
  const auto refused = stream->NextFrame();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->status().code(), kOutOfRange);
  EXPECT_THAT(refused->status().message(), HasSubstr("capture_time"));
  EXPECT_THAT(refused->status().message(), HasSubstr("is late"));
  EXPECT_EQ(PositionsOf(*refused), PositionsOf(fills.back()));
  v1::TargetFrame next = ClipFrame(kFrames + 2);
  SetTime(60000, next);
  ASSERT_TRUE(stream->SendFrame(next));
  const auto answer = stream->NextFrame();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status().code(), 0) << answer->status().message();
  EXPECT_EQ(answer->timing().out_of_order_count(), 1);
}

TEST_F(FilledSessionTest, GoingOnFromAFillIsExact) {
  const v1::CreateSessionRequest request =
      Follower(Filling(StreamConditioning::LATE_POLICY_EXTRAPOLATE));
  const auto stream = OpenStream({AttachRequest(CreateSession(request))});
  Play(*stream);
  const auto fills = Fills(*stream);
  ASSERT_FALSE(fills.empty());
  v1::AttachSession attach = AttachRequest(CreateSession(request));
  *attach.mutable_resume_from() = fills.back();
  // In one message, so that no fill comes between.
  v1::StreamingSolveRequest next;
  for (int i = kFrames + 1; i <= kFrames + 5; ++i) {
    v1::TargetFrame& frame = *next.add_frames();
    frame = ClipFrame(i);
    SetTime(60000 + i * kFrameMs, frame);
  }
  ASSERT_TRUE(stream->Send(next));
  const auto resumed = OpenStream();
  *next.add_attach() = attach;
  ASSERT_TRUE(resumed->Send(next));
  const auto event = resumed->NextNews();
  ASSERT_TRUE(event && event->kind() == v1::StreamEvent::KIND_ATTACHED);
  EXPECT_EQ(event->status().code(), 0) << event->status().message();
  const auto answers = stream->NextFrames(5);
  const auto same = resumed->NextFrames(5);
  ASSERT_EQ(answers.size(), 5u);
  ASSERT_EQ(same.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    EXPECT_FALSE(answers[i].timing().filled());
    EXPECT_FALSE(same[i].timing().filled());
    EXPECT_EQ(PositionsOf(answers[i]), PositionsOf(same[i])) << i;
  }
}

TEST_F(FilledSessionTest, AResumedActorStillComesToRest) {
  const v1::CreateSessionRequest request =
      Follower(Filling(StreamConditioning::LATE_POLICY_EXTRAPOLATE));
  const auto stream = OpenStream({AttachRequest(CreateSession(request))});
  Play(*stream);
  const auto first = stream->NextFrame();
  ASSERT_TRUE(first && first->timing().filled());
  v1::AttachSession attach = AttachRequest(CreateSession(request));
  *attach.mutable_resume_from() = *first;
  const auto resumed = OpenStream({attach});
  const auto fills = Fills(*resumed);
  ASSERT_FALSE(fills.empty());
  EXPECT_EQ(fills.back().timing().source(), FrameTiming::SOURCE_EASED);
  EXPECT_EQ(fills.back().sequence_number(), kFrames);
}

TEST_F(FilledSessionTest, FramesOfALongMessageAreNotLate) {
  for (v1::FramePolicy policy :
       {v1::FRAME_POLICY_EVERY_FRAME, v1::FRAME_POLICY_LATEST_WINS}) {
    v1::AttachSession attach = AttachRequest(CreateSession(
        Follower(Filling(StreamConditioning::LATE_POLICY_EXTRAPOLATE, 2))));
    attach.set_frame_policy(policy);
    const auto stream = OpenStream({attach});
    // Far more than are solved in 2 ms, and than answers may wait.
    constexpr int kMany = 1000;
    v1::StreamingSolveRequest request;
    for (int i = 1; i <= kMany; ++i) {
      v1::TargetFrame& frame = *request.add_frames();
      frame = testing::SourceFrame(Clip(), (i - 1) % 60 + 1);
      frame.set_sequence_number(i);
      SetTime(i * kFrameMs, frame);
    }
    ASSERT_TRUE(stream->Send(request));
    int64_t newest = 0;
    while (newest < kMany) {
      const auto answer = stream->NextFrame();
      ASSERT_TRUE(answer);
      ASSERT_EQ(answer->status().code(), 0) << answer->status().message();
      ASSERT_FALSE(answer->timing().filled()) << newest;
      newest = answer->sequence_number();
    }
  }
}

TEST_F(FilledSessionTest, EachSlotHasItsOwnInterval) {
  // The alarm is set for the longer one first.
  std::vector<v1::AttachSession> attach;
  for (int interval_ms : {900, kFrameMs}) {
    v1::CreateSessionRequest request = Follower(
        Filling(StreamConditioning::LATE_POLICY_EXTRAPOLATE, interval_ms));
    request.mutable_session()->set_affinity_key("both");
    attach.push_back(AttachRequest(CreateSession(request)));
  }
  const auto stream = OpenStream(attach);
  for (int slot : {0, 1}) {
    v1::TargetFrame frame = ClipFrame(1);
    frame.set_slot(slot);
    ASSERT_TRUE(stream->SendFrame(frame));
    ASSERT_TRUE(stream->NextFrame());
  }
  const auto first = stream->NextFrame();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->slot(), 1);
}

TEST_F(FilledSessionTest, AFillHasTheNumberOfTheNewestFrame) {
  const auto stream = OpenStream({AttachRequest(CreateSession(
      Follower(Filling(StreamConditioning::LATE_POLICY_HOLD, 200))))});
  Play(*stream);
  v1::TargetFrame bad = ClipFrame(kFrames + 1);
  bad.mutable_source_pose()->clear_positions();
  ASSERT_TRUE(stream->SendFrame(bad));
  const auto refused = stream->NextFrame();
  ASSERT_TRUE(refused);
  EXPECT_NE(refused->status().code(), 0);
  const auto fill = stream->NextFrame();
  ASSERT_TRUE(fill && fill->timing().filled());
  EXPECT_EQ(fill->sequence_number(), kFrames + 1);
}

TEST_F(FilledSessionTest, AViewerSeesTheWayToRest) {
  const std::string session = CreateSession(
      Follower(Filling(StreamConditioning::LATE_POLICY_EXTRAPOLATE)));
  const auto stream = OpenStream({AttachRequest(session)});
  grpc::ClientContext context;
  v1::WatchSessionRequest request;
  request.set_name(session);
  request.mutable_min_interval()->set_nanos(1'000'000);
  const auto viewer = connection().sessions().WatchSession(&context, request);
  Play(*stream);
  const auto fills = Fills(*stream);
  ASSERT_FALSE(fills.empty());
  // Others than those of frames, and in the end the same as the driver.
  int seen = 0;
  v1::WatchSessionResponse response;
  Positions pose;
  while (pose != PositionsOf(fills.back())) {
    ASSERT_TRUE(viewer->Read(&response));
    pose.assign(response.pose().positions().begin(),
                response.pose().positions().end());
    for (const v1::PoseFrame& fill : fills) {
      if (pose == PositionsOf(fill)) {
        ++seen;
        break;
      }
    }
  }
  EXPECT_GE(seen, 2);
  context.TryCancel();
  viewer->Finish();
}

TEST_F(FilledSessionTest, WhoLosesTheSessionFillsNoMore) {
  const std::string session = CreateSession(
      Follower(Filling(StreamConditioning::LATE_POLICY_EXTRAPOLATE)));
  const auto stream = OpenStream({AttachRequest(session)});
  Play(*stream);
  ASSERT_TRUE(stream->NextFrame());
  v1::AttachSession attach = AttachRequest(session);
  attach.set_take_over(true);
  const auto other = OpenStream({attach});
  const auto event = stream->NextNews();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind(), v1::StreamEvent::KIND_DETACHED);
  // Nor does the other before a frame of its own: it has another clock.
  EXPECT_FALSE(other->NextFrame(kSilence));
  while (stream->NextFrame(absl::ZeroDuration())) {
  }
  EXPECT_FALSE(stream->NextFrame(kSilence));
}

TEST_F(FilledSessionTest, ADetachedSlotFillsNoMore) {
  const auto stream = OpenStream({AttachRequest(CreateSession(
      Follower(Filling(StreamConditioning::LATE_POLICY_EXTRAPOLATE, 2))))});
  Play(*stream);
  ASSERT_TRUE(stream->NextFrame());
  v1::StreamingSolveRequest request;
  request.add_detach(0);
  ASSERT_TRUE(stream->Send(request));
  const auto event = stream->NextNews();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind(), v1::StreamEvent::KIND_DETACHED);
  while (stream->NextFrame(absl::ZeroDuration())) {
  }
  EXPECT_FALSE(stream->NextFrame(kSilence));
}

TEST_F(FilledSessionTest, TheClientLibraryPassesFillsThrough) {
  auto shared = std::make_shared<client::Connection>(server().target());
  client::SessionSpec spec;
  spec.session = Follower(Filling(StreamConditioning::LATE_POLICY_EXTRAPOLATE));
  spec.frame_policy = v1::FRAME_POLICY_EVERY_FRAME;
  auto stream = client::SessionStream::Open(shared, {}, {spec});
  ASSERT_EQ(stream.status(), absl::OkStatus());
  for (int i = 1; i <= 3; ++i) {
    ASSERT_EQ((*stream)->Send(ClipFrame(i), testing::kPatience),
              absl::OkStatus());
  }
  int answered = 0;
  int filled = 0;
  while (answered < 3 || filled < 2) {
    const auto answer = (*stream)->Receive(testing::kPatience);
    ASSERT_EQ(answer.status(), absl::OkStatus());
    ASSERT_TRUE(answer->has_value());
    const bool is_fill = (*answer)->timing().filled();
    EXPECT_EQ((*answer)->status().code(), 0);
    ++(is_fill ? filled : answered);
  }
  EXPECT_EQ((*stream)->statistics().answered_frames, 3);
  EXPECT_EQ((*stream)->Close(testing::kPatience), absl::OkStatus());
}

TEST_F(FilledSessionTest, WhoDoesNotReadMissesFills) {
  StreamConditioning conditioning =
      Filling(StreamConditioning::LATE_POLICY_EXTRAPOLATE, 2);
  conditioning.mutable_ease_duration()->set_seconds(3);
  const auto stream =
      OpenStream({AttachRequest(CreateSession(Follower(conditioning)))});
  Play(*stream);
  absl::SleepFor(absl::Seconds(4.5));
  const auto fills = Fills(*stream);
  ASSERT_FALSE(fills.empty());
  // Of some 1500.
  EXPECT_LT(fills.size(), 750u);
  EXPECT_EQ(fills.back().timing().source(), FrameTiming::SOURCE_EASED);
  for (size_t i = 1; i < fills.size(); ++i) {
    EXPECT_GT(Seconds(fills[i].capture_time()),
              Seconds(fills[i - 1].capture_time()));
  }
}

TEST_F(FilledSessionTest, AStreamThatEndsFillsNoMore) {
  const v1::CreateSessionRequest request =
      Follower(Filling(StreamConditioning::LATE_POLICY_EXTRAPOLATE, 2));
  for (int i = 0; i < 20; ++i) {
    const auto stream = OpenStream({AttachRequest(CreateSession(request))});
    Play(*stream);
    stream->NextFrame();
    if (i % 2 == 0) {
      stream->Cancel();
    } else {
      stream->HalfClose();
    }
    stream->Finish().IgnoreError();
  }
}

TEST_F(FilledSessionTest, BadIntervalsAreNamed) {
  const auto refuse = [](int64_t seconds, int nanos, const char* words) {
    StreamConditioning conditioning;
    conditioning.mutable_fill_interval()->set_seconds(seconds);
    conditioning.mutable_fill_interval()->set_nanos(nanos);
    EXPECT_THAT(
        Call(&v1::SessionService::Stub::CreateSession, Follower(conditioning))
            .status(),
        Fails(absl::StatusCode::kInvalidArgument, words));
  };
  for (const int ms : {2, 10000}) {
    StreamConditioning conditioning;
    conditioning.mutable_fill_interval()->set_seconds(ms / 1000);
    conditioning.mutable_fill_interval()->set_nanos(ms % 1000 * 1000000);
    EXPECT_EQ(
        Call(&v1::SessionService::Stub::CreateSession, Follower(conditioning))
            .status(),
        absl::OkStatus());
  }
  refuse(0, 0, "session.conditioning.fill_interval: want more than 0");
  refuse(0, 1000, "session.conditioning.fill_interval: want 0.002 to 10 s");
  refuse(-1, 0, "session.conditioning.fill_interval: want 0.002 to 10 s");
  refuse(11, 0, "session.conditioning.fill_interval: want 0.002 to 10 s");
}

}  // namespace
}  // namespace gelenk
