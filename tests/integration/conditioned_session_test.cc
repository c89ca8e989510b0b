// Sessions that clean and time their frames, over the wire.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "gelenk/motion/frame_conditioner.h"
#include "gelenk/retarget/live_retargeter.h"
#include "tests/integration/follower_test.h"
#include "tests/testing/followed_body.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using testing::ArmSessionRequest;
using testing::AttachRequest;
using testing::Fails;
using ::testing::HasSubstr;
using testing::kReachGoal;
using testing::SolveStream;
using v1::FrameTiming;
using v1::StreamConditioning;
using v1::StreamEvent;

constexpr int kFrames = 60;
constexpr int kFrameMs = 20;
constexpr int kDeadlineExceeded = 4;
constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

using Positions = std::vector<double>;

Positions PositionsOf(const v1::PoseFrame& frame) {
  return {frame.pose().positions().begin(), frame.pose().positions().end()};
}

void SetTime(int number, v1::TargetFrame& frame) {
  frame.mutable_capture_time()->set_seconds(number * kFrameMs / 1000);
  frame.mutable_capture_time()->set_nanos(number * kFrameMs % 1000 * 1000000);
}

class ConditionedSessionTest : public FollowerTest {
 protected:
  static v1::CreateSessionRequest Arm(const StreamConditioning& conditioning) {
    v1::CreateSessionRequest request = ArmSessionRequest();
    *request.mutable_session()->mutable_conditioning() = conditioning;
    return request;
  }

  static v1::TargetFrame ClipFrame(int number) {
    v1::TargetFrame frame = testing::SourceFrame(Clip(), number);
    SetTime(number, frame);
    return frame;
  }

  // The clip with a gap of `missing` frames behind the first 20.
  static v1::TargetFrame GapFrame(int number, int missing) {
    v1::TargetFrame frame = ClipFrame(number);
    if (number > 20 && number <= 20 + missing) frame.clear_source_pose();
    return frame;
  }

  static v1::TargetFrame ReachFrame(int number) {
    v1::TargetFrame frame =
        testing::ReachFrame(number, 0.9 + 0.2 * std::sin(0.3 * number), 0.5);
    SetTime(number, frame);
    return frame;
  }

  using MakeFrame = std::function<v1::TargetFrame(int number)>;

  static std::vector<v1::PoseFrame> Play(SolveStream& stream,
                                         const MakeFrame& make_frame,
                                         int first = 1, int last = kFrames) {
    v1::StreamingSolveRequest request;
    for (int i = first; i <= last; ++i) *request.add_frames() = make_frame(i);
    EXPECT_TRUE(stream.Send(request));
    return stream.NextFrames(last - first + 1);
  }

  static std::vector<v1::PoseFrame> Play(
      const v1::CreateSessionRequest& request, const MakeFrame& make_frame) {
    const auto stream = OpenStream({AttachRequest(CreateSession(request))});
    return Play(*stream, make_frame);
  }

  static void ExpectExactResume(const v1::CreateSessionRequest& request,
                                const MakeFrame& make_frame) {
    const auto all = Play(request, make_frame);
    for (int last : {1, 10, 22, 35}) {
      v1::AttachSession attach = AttachRequest(CreateSession(request));
      *attach.mutable_resume_from() = all[last - 1];
      const auto stream = OpenStream();
      ASSERT_TRUE(stream->Attach(attach));
      const auto event = stream->NextNews();
      ASSERT_TRUE(event && event->kind() == StreamEvent::KIND_ATTACHED)
          << event->DebugString();
      EXPECT_EQ(event->status().code(), 0) << event->status().message();
      const auto answers = Play(*stream, make_frame, last + 1);
      for (int i = last; i < kFrames; ++i) {
        ASSERT_EQ(PositionsOf(answers[i - last]), PositionsOf(all[i]))
            << "resumed from " << last << ", frame " << i + 1;
      }
    }
  }
};

TEST_F(ConditionedSessionTest, OneEuroIsTheLibrarysAndStatesItsLatency) {
  StreamConditioning conditioning;
  conditioning.set_filter(StreamConditioning::FILTER_ONE_EURO);
  const auto answers = Play(Follower(conditioning), ClipFrame);
  LiveRetargetSpec spec;
  spec.source = Clip().model;
  spec.target = testing::HeroModel();
  spec.frame_time_s = Clip().frame_time_s;
  const auto live = *LiveRetargeter::Create(spec);
  auto smoother = *Smoother::Create(Clip().model->skeleton);
  Eigen::VectorXd smooth;
  for (int f = 0; f < kFrames; ++f) {
    smooth = Clip().positions.col(f);
    const absl::Duration time = absl::Milliseconds(kFrameMs) * (f + 1);
    ASSERT_TRUE(smoother.Push(absl::ToDoubleSeconds(time), smooth, smooth));
    live->NoteFrame(time);
    live->Step(smooth);
    ASSERT_EQ(PositionsOf(answers[f]),
              Positions(live->positions().begin(), live->positions().end()))
        << f;
    EXPECT_NEAR(1e-9 * answers[f].timing().latency().nanos(),
                smoother.latency_s(), 1e-9);
  }
  EXPECT_GT(answers.back().timing().latency().nanos(), 0);
}

TEST_F(ConditionedSessionTest, WithoutConditioningAFrameMustCome) {
  const auto stream = OpenStream(
      {AttachRequest(CreateSession(testing::FollowerRequest(Clip())))});
  const auto answers = Play(
      *stream, [](int i) { return GapFrame(i, 1); }, 1, 22);
  EXPECT_THAT(answers[20].status().message(), HasSubstr("source_pose"));
  EXPECT_EQ(answers[21].status().code(), 0);
}

TEST_F(ConditionedSessionTest, MissingFramesAreHeld) {
  const auto answers = Play(Follower(StreamConditioning()),
                            [](int i) { return GapFrame(i, 10); });
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_EQ(answers[i].status().code(), 0) << answers[i].DebugString();
  }
  EXPECT_EQ(answers[19].timing().source(), FrameTiming::SOURCE_FRAMES);
  EXPECT_EQ(answers[25].timing().source(), FrameTiming::SOURCE_HELD);
  EXPECT_EQ(answers[30].timing().source(), FrameTiming::SOURCE_FRAMES);
  // 120 ms after the last one that came, at least.
  EXPECT_GE(answers[25].timing().age().nanos(), 119'000'000);
}

TEST_F(ConditionedSessionTest, MissingFramesAreExtrapolatedThenEased) {
  StreamConditioning conditioning;
  conditioning.set_late_policy(StreamConditioning::LATE_POLICY_EXTRAPOLATE);
  conditioning.mutable_extrapolation_limit()->set_nanos(100'000'000);
  conditioning.mutable_ease_duration()->set_nanos(200'000'000);
  const auto answers =
      Play(Follower(conditioning), [](int i) { return GapFrame(i, 30); });
  EXPECT_EQ(answers[22].timing().source(), FrameTiming::SOURCE_EXTRAPOLATED);
  EXPECT_EQ(answers[30].timing().source(), FrameTiming::SOURCE_EASED);
  // Z of the root: it went on for a while, and stays.
  const auto z = [&](int i) { return PositionsOf(answers[i])[2]; };
  EXPECT_GT(z(22), z(19));
  EXPECT_NEAR(z(48), z(45), 0.01);
  EXPECT_GT(z(48), z(19));
  // And comes back without a jump.
  for (int i = 1; i < kFrames; ++i) {
    const Positions before = PositionsOf(answers[i - 1]);
    const Positions now = PositionsOf(answers[i]);
    for (size_t k = 0; k < now.size(); ++k) {
      ASSERT_LT(std::abs(now[k] - before[k]), 0.2) << i << ", " << k;
    }
  }
}

TEST_F(ConditionedSessionTest, MissingFramesAreDropped) {
  StreamConditioning conditioning;
  conditioning.set_late_policy(StreamConditioning::LATE_POLICY_DROP);
  const auto answers =
      Play(Follower(conditioning), [](int i) { return GapFrame(i, 10); });
  for (int i = 0; i < kFrames; ++i) {
    // The first is no later than jitter.
    const bool is_late = i > 20 && i < 30;
    EXPECT_EQ(answers[i].status().code(), is_late ? kDeadlineExceeded : 0) << i;
    EXPECT_EQ(answers[i].sequence_number(), i + 1);
    if (!is_late) continue;
    EXPECT_EQ(PositionsOf(answers[i]), PositionsOf(answers[20]));
  }
}

TEST_F(ConditionedSessionTest, TargetsOfGoalsAreFiltered) {
  StreamConditioning conditioning;
  conditioning.set_filter(StreamConditioning::FILTER_EXPONENTIAL);
  conditioning.mutable_time_constant()->set_nanos(100'000'000);
  // Half a metre at once.
  const auto jump = [](int i) {
    v1::TargetFrame frame = testing::ReachFrame(i, 0.9, i == 1 ? 0.5 : 0);
    SetTime(i, frame);
    return frame;
  };
  const auto raw = Play(ArmSessionRequest(), jump);
  const auto smooth = Play(Arm(conditioning), jump);
  const auto step = [](const std::vector<v1::PoseFrame>& frames, int i) {
    double most = 0;
    for (int k = 0; k < 3; ++k) {
      most = std::max(most, std::abs(PositionsOf(frames[i])[k] -
                                     PositionsOf(frames[i - 1])[k]));
    }
    return most;
  };
  EXPECT_LT(step(smooth, 1), 0.4 * step(raw, 1));
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(PositionsOf(smooth.back())[k], PositionsOf(raw.back())[k],
                0.01);
  }
}

TEST_F(ConditionedSessionTest, ResumeIsExact) {
  StreamConditioning conditioning;
  conditioning.set_filter(StreamConditioning::FILTER_ONE_EURO);
  conditioning.set_late_policy(StreamConditioning::LATE_POLICY_EXTRAPOLATE);
  ExpectExactResume(Follower(conditioning),
                    [](int i) { return GapFrame(i, 10); });
  ExpectExactResume(Arm(conditioning), ReachFrame);
}

TEST_F(ConditionedSessionTest, AJitterBufferStatesItsLatencyAndIsNotExact) {
  StreamConditioning conditioning;
  conditioning.set_jitter_buffer_frames(3);
  conditioning.mutable_frame_interval()->set_nanos(kFrameMs * 1000000);
  const auto answers = Play(Follower(conditioning), ClipFrame);
  EXPECT_EQ(answers.back().status().code(), 0);
  EXPECT_EQ(answers.back().timing().latency().nanos(), 3 * kFrameMs * 1000000);
  v1::AttachSession attach =
      AttachRequest(CreateSession(Follower(conditioning)));
  *attach.mutable_resume_from() = answers.back();
  const auto stream = OpenStream();
  ASSERT_TRUE(stream->Attach(attach));
  const auto event = stream->NextNews();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind(), StreamEvent::KIND_ATTACHED);
  EXPECT_THAT(event->status().message(), HasSubstr("jitter buffer"));
}

TEST_F(ConditionedSessionTest, EveryAnswerToATimedFrameTellsItsAge) {
  const auto timed = Play(ArmSessionRequest(), ReachFrame);
  const auto untimed = Play(ArmSessionRequest(), [](int i) {
    v1::TargetFrame frame = ReachFrame(i);
    frame.clear_capture_time();
    return frame;
  });
  for (int i = 0; i < kFrames; ++i) {
    ASSERT_TRUE(timed[i].timing().has_age());
    EXPECT_GE(timed[i].timing().age().nanos(), 0);
    EXPECT_FALSE(untimed[i].has_timing());
    EXPECT_EQ(PositionsOf(timed[i]), PositionsOf(untimed[i]));
  }
}

TEST_F(ConditionedSessionTest, FramesOutOfOrderAreDroppedAndCounted) {
  const auto stream =
      OpenStream({AttachRequest(CreateSession(ArmSessionRequest()))});
  v1::StreamingSolveRequest request;
  for (int number : {1, 2, 4, 3, 4, 5}) {
    *request.add_frames() = ReachFrame(number);
  }
  ASSERT_TRUE(stream->Send(request));
  const auto answers = stream->NextFrames(6);
  ASSERT_EQ(answers.size(), 6u);
  EXPECT_EQ(answers[2].timing().out_of_order_count(), 0);
  for (int i : {3, 4}) {
    EXPECT_THAT(answers[i].status().message(), HasSubstr("sequence_number"));
    EXPECT_EQ(PositionsOf(answers[i]), PositionsOf(answers[2]));
  }
  EXPECT_EQ(answers[5].sequence_number(), 5);
  EXPECT_EQ(answers[5].timing().out_of_order_count(), 2);
}

TEST_F(ConditionedSessionTest, BadConditioningIsNamed) {
  const auto refuse = [](const StreamConditioning& conditioning,
                         const char* words) {
    for (const auto& request : {Follower(conditioning), Arm(conditioning)}) {
      EXPECT_THAT(
          Call(&v1::SessionService::Stub::CreateSession, request).status(),
          Fails(kInvalid, words));
    }
  };
  StreamConditioning conditioning;
  conditioning.set_jitter_buffer_frames(-1);
  refuse(conditioning, "session.conditioning.jitter_buffer_frames");
  conditioning.set_jitter_buffer_frames(2);
  refuse(conditioning, "session.conditioning.frame_interval");
  conditioning.Clear();
  conditioning.set_filter(StreamConditioning::FILTER_ONE_EURO);
  conditioning.set_min_cutoff_hz(0);
  refuse(conditioning, "session.conditioning.min_cutoff_hz");
  conditioning.Clear();
  conditioning.mutable_ease_duration();
  refuse(conditioning, "session.conditioning.ease_s");
}

TEST_F(ConditionedSessionTest, FramesWithoutTimeAreRefused) {
  const auto stream = OpenStream(
      {AttachRequest(CreateSession(Follower(StreamConditioning())))});
  const auto answers = Play(
      *stream, [](int i) { return testing::SourceFrame(Clip(), i); }, 1, 1);
  EXPECT_THAT(answers[0].status().message(), HasSubstr("capture_time"));
}

}  // namespace
}  // namespace gelenk
