// What stands for frames that do not come, by times that are passed in.
#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

#include "server/session/session.h"
#include "server/session/session_recording.h"
#include "tests/testing/example_sessions.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/status_matchers.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::ArmGoals;
using ::gelenk::testing::Fails;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::ReachFrame;

constexpr DriverId kDriver = 7;
constexpr absl::Duration kFrame = absl::Milliseconds(20);
// The client's clock begins so long before ours.
constexpr absl::Duration kOffset = absl::Seconds(500);
// Times since 1970 in double are exact to a quarter of it, and moments are
// whole microseconds.
constexpr absl::Duration kTimeRounding = absl::Microseconds(2);
const absl::Time kEpoch = absl::UnixEpoch() + kOffset;

ConditioningOptions Filling(LatePolicy policy) {
  ConditioningOptions options;
  options.late_policy = policy;
  options.fill_interval_s = absl::ToDoubleSeconds(kFrame);
  return options;
}

ConditioningOptions Buffered(int frames) {
  ConditioningOptions options = Filling(LatePolicy::kHold);
  options.jitter_frames = frames;
  options.frame_interval_s = absl::ToDoubleSeconds(kFrame);
  return options;
}

// A driven arm whose targets are conditioned.
class Driven {
 public:
  explicit Driven(const ConditioningOptions& options)
      : skeleton_(PlanarChain(Eigen::Vector3d::Zero(), {0.5, 0.5, 0.5})) {
    const auto trees = std::make_shared<SharedTrees>(skeleton_);
    SessionState state;
    state.goals = ArmGoals();
    state.positions = Eigen::Vector3d(0.1, 0.2, 0.3);
    state.cold = false;
    SessionInput input;
    input.conditioning =
        *FrameConditioning::OfTargets(options, absl::MakeSpan(state.goals));
    session_ =
        std::make_shared<Session>("sessions/arm", "skeletons/arm", "arm", trees,
                                  trees->CreateProblem(state.goals).value(),
                                  state, kEpoch, std::move(input));
    EXPECT_TRUE(session_->Claim(kDriver, false, kEpoch).ok());
  }

  Session& operator*() { return *session_; }
  Session* operator->() { return session_.get(); }
  const std::shared_ptr<const Skeleton>& skeleton() const { return skeleton_; }

  // Frame `number` of a motion, captured on time, `way` on its way.
  absl::Status Send(int number, absl::Duration way = absl::ZeroDuration()) {
    return Send(number, number * kFrame, way);
  }
  absl::Status Send(int number, absl::Duration capture_time,
                    absl::Duration way) {
    InputFrame frame = ReachFrame(number, 0.7 + 0.01 * number, 0.5);
    frame.capture_time = capture_time;
    const absl::Status status =
        session_->Apply(kDriver, frame, kEpoch + capture_time + way);
    return status.ok() ? Solve() : status;
  }
  // A frame without targets.
  absl::Status SendEmpty(int number, absl::Duration capture_time) {
    InputFrame frame;
    frame.sequence_number = number;
    frame.capture_time = capture_time;
    const absl::Status status =
        session_->Apply(kDriver, frame, kEpoch + capture_time);
    return status.ok() ? Solve() : status;
  }
  // What stands for a frame when it is `time` by the client's clock.
  absl::Status Fill(absl::Duration time) {
    InputFrame frame;
    frame.is_fill = true;
    const absl::Status status = session_->Apply(kDriver, frame, kEpoch + time);
    filled_at_ = frame.capture_time;
    return status.ok() ? Solve() : status;
  }

  absl::Duration filled_at() const { return filled_at_.value(); }
  const SolvedFrame& solved() const { return solved_; }
  LiveStatus::State state() const { return solved_.live->state; }
  Eigen::VectorXd positions() const {
    Eigen::VectorXd positions;
    session_->CopyPositions(positions);
    return positions;
  }

 private:
  absl::Status Solve() {
    return session_->Solve(kDriver, solver_, true, solved_);
  }

  const std::shared_ptr<const Skeleton> skeleton_;
  std::shared_ptr<Session> session_;
  IkSolver solver_;
  SolvedFrame solved_;
  std::optional<absl::Duration> filled_at_;
};

void SendTen(Driven& arm) {
  for (int i = 1; i <= 10; ++i) ASSERT_EQ(arm.Send(i), absl::OkStatus());
}

TEST(SessionFillTest, IsAsOfAFrameByTheFastestWay) {
  Driven arm(Filling(LatePolicy::kHold));
  ASSERT_EQ(arm.Send(1, absl::Milliseconds(30)), absl::OkStatus());
  ASSERT_EQ(arm.Send(2, absl::Milliseconds(12)), absl::OkStatus());
  ASSERT_EQ(arm.Send(3, absl::Milliseconds(15)), absl::OkStatus());
  ASSERT_EQ(arm.Fill(absl::Milliseconds(100)), absl::OkStatus());
  EXPECT_LE(absl::AbsDuration(arm.filled_at() - absl::Milliseconds(88)),
            kTimeRounding);
}

TEST(SessionFillTest, IsWhatAnEmptyFrameGives) {
  for (LatePolicy policy : {LatePolicy::kHold, LatePolicy::kExtrapolate}) {
    Driven filled(Filling(policy));
    Driven asked(Filling(policy));
    SendTen(filled);
    SendTen(asked);
    for (int i = 11; i <= 60; ++i) {
      ASSERT_EQ(filled.Fill(i * kFrame), absl::OkStatus());
      ASSERT_EQ(asked.SendEmpty(i, filled.filled_at()), absl::OkStatus());
      ASSERT_EQ(filled.positions(), asked.positions()) << i;
      ASSERT_EQ(filled.state(), asked.state()) << i;
    }
    EXPECT_TRUE(filled.solved().live->is_settled);
    // And when frames come again.
    for (int i = 61; i <= 80; ++i) {
      ASSERT_EQ(filled.Send(i), absl::OkStatus());
      ASSERT_EQ(asked.Send(i), absl::OkStatus());
      ASSERT_EQ(filled.positions(), asked.positions()) << i;
    }
  }
}

TEST(SessionFillTest, DroppedFramesAreToldOf) {
  Driven arm(Filling(LatePolicy::kDrop));
  SendTen(arm);
  const Eigen::VectorXd before = arm.positions();
  EXPECT_THAT(arm.Fill(absl::Seconds(1)),
              Fails(absl::StatusCode::kDeadlineExceeded, "late"));
  EXPECT_TRUE(arm.solved().live->is_settled);
  EXPECT_EQ(arm.positions(), before);
}

TEST(SessionFillTest, UsesUpNoNumberAndNoLife) {
  Driven arm(Filling(LatePolicy::kExtrapolate));
  SendTen(arm);
  const absl::Time expires = arm->Snapshot().expire_time;
  ASSERT_EQ(arm.Fill(absl::Seconds(1)), absl::OkStatus());
  EXPECT_EQ(arm->sequence_number(), 10);
  EXPECT_EQ(arm->Snapshot().expire_time, expires);
  EXPECT_EQ(arm.Send(11, absl::Seconds(2), absl::ZeroDuration()),
            absl::OkStatus());
}

TEST(SessionFillTest, IsOnlyTheDrivers) {
  Driven arm(Filling(LatePolicy::kHold));
  SendTen(arm);
  ASSERT_TRUE(arm->Claim(kDriver + 1, true, kEpoch).ok());
  EXPECT_THAT(arm.Fill(absl::Seconds(1)),
              Fails(absl::StatusCode::kAborted, "taken over"));
}

TEST(SessionFillTest, NeedsAFrameBefore) {
  Driven arm(Filling(LatePolicy::kHold));
  EXPECT_THAT(arm.Fill(absl::Seconds(1)),
              Fails(absl::StatusCode::kInvalidArgument, "none came before"));
  EXPECT_EQ(arm.Send(1), absl::OkStatus());
}

TEST(SessionFillTest, NeverGoesBack) {
  Driven arm(Filling(LatePolicy::kExtrapolate));
  SendTen(arm);
  ASSERT_EQ(arm.Fill(absl::Milliseconds(300)), absl::OkStatus());
  absl::Duration before = arm.filled_at();
  // The machine's clock was set back.
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(arm.Fill(absl::Milliseconds(100)), absl::OkStatus());
    EXPECT_GT(arm.filled_at(), before);
    before = arm.filled_at();
  }
}

TEST(SessionFillTest, FramesFromBeforeItAreLate) {
  Driven arm(Filling(LatePolicy::kExtrapolate));
  SendTen(arm);
  ASSERT_EQ(arm.Fill(13 * kFrame), absl::OkStatus());
  const Eigen::VectorXd before = arm.positions();
  const std::vector<double> memory = arm->Snapshot().memory;
  EXPECT_THAT(arm.Send(11, 4 * kFrame),
              Fails(absl::StatusCode::kOutOfRange, "capture_time: 220ms"));
  EXPECT_THAT(arm.Send(12, arm.filled_at(), kFrame),
              Fails(absl::StatusCode::kOutOfRange, "is late"));
  EXPECT_EQ(arm.positions(), before);
  EXPECT_EQ(arm->Snapshot().memory, memory);
  EXPECT_EQ(arm->sequence_number(), 12) << "their numbers are used up";
  EXPECT_EQ(arm.Send(13, arm.filled_at() + absl::Milliseconds(1),
                     absl::Milliseconds(1)),
            absl::OkStatus());
}

TEST(SessionFillTest, AnotherDriverHasAnotherClock) {
  Driven arm(Filling(LatePolicy::kHold));
  SendTen(arm);
  ASSERT_EQ(arm.Fill(absl::Seconds(1)), absl::OkStatus());
  arm->Release(kDriver);
  ASSERT_TRUE(arm->Claim(kDriver, false, kEpoch).ok());
  EXPECT_EQ(arm.Send(11, absl::Milliseconds(1), absl::Seconds(3)),
            absl::OkStatus());
}

TEST(SessionFillTest, AJitterBufferStillShowsWhatComesBehindAFill) {
  Driven arm(Buffered(3));
  SendTen(arm);
  SessionRecording* recording = nullptr;
  {
    auto made =
        std::make_shared<SessionRecording>(arm.skeleton(), 100, nullptr);
    recording = made.get();
    ASSERT_TRUE(arm->StartRecording(std::move(made)).ok());
  }
  // Shown is what was captured three frames before.
  ASSERT_EQ(arm.Fill(12 * kFrame), absl::OkStatus());
  EXPECT_EQ(arm.state(), LiveStatus::State::kPlaying);
  ASSERT_EQ(arm.Fill(13 * kFrame), absl::OkStatus());
  EXPECT_EQ(arm.state(), LiveStatus::State::kPlaying);
  EXPECT_EQ(arm.Send(11, absl::Milliseconds(41)), absl::OkStatus());
  ASSERT_EQ(arm.Fill(14 * kFrame), absl::OkStatus());
  EXPECT_EQ(arm.state(), LiveStatus::State::kPlaying);
  // What should have been shown by now is late.
  ASSERT_EQ(arm.Fill(16 * kFrame), absl::OkStatus());
  EXPECT_THAT(arm.Send(12, 5 * kFrame),
              Fails(absl::StatusCode::kOutOfRange, "is late"));
  EXPECT_EQ(arm.Send(14, 3 * kFrame), absl::OkStatus());
  // Its times only grow.
  EXPECT_EQ(recording->left_out_count(), 0);
}

TEST(SessionFillTest, BufferedFramesAreShownAtAnEvenPace) {
  Driven late(Buffered(4));
  Driven in_time(Buffered(4));
  SendTen(late);
  SendTen(in_time);
  // All of them come, but those of one in four frames do so with the next ones.
  for (int i = 11; i <= 12; ++i) {
    ASSERT_EQ(late.Fill(i * kFrame), absl::OkStatus());
    ASSERT_EQ(in_time.Send(i), absl::OkStatus());
    EXPECT_LT((late.positions() - in_time.positions()).norm(), 1e-6) << i;
  }
  for (int i = 11; i <= 12; ++i) {
    ASSERT_EQ(late.Send(i, (13 - i) * kFrame), absl::OkStatus());
  }
  for (int i = 14; i <= 20; ++i) {
    if (i == 14) {
      ASSERT_EQ(late.Send(13, kFrame), absl::OkStatus());
      ASSERT_EQ(in_time.Send(13), absl::OkStatus());
    }
    ASSERT_EQ(late.Send(i), absl::OkStatus());
    ASSERT_EQ(in_time.Send(i), absl::OkStatus());
    EXPECT_LT((late.positions() - in_time.positions()).norm(), 1e-6) << i;
  }
}

class SessionFillResumeTest : public ::testing::Test {
 protected:
  static void Resume(Driven& from, Driven& to) {
    const SessionSnapshot snapshot = from->Snapshot();
    ResumeState state;
    state.positions = snapshot.state.positions;
    state.sequence_number = from->sequence_number();
    state.goals = &snapshot.state.goals;
    state.motion = &snapshot.motion;
    state.memory = &snapshot.memory;
    ASSERT_EQ(to->Resume(kDriver, state), absl::OkStatus());
  }
};

TEST_F(SessionFillResumeTest, GoesOnExactly) {
  for (int last : {11, 16, 50}) {
    Driven arm(Filling(LatePolicy::kExtrapolate));
    SendTen(arm);
    for (int i = 11; i <= last; ++i) {
      ASSERT_EQ(arm.Fill(i * kFrame), absl::OkStatus());
    }
    Driven resumed(Filling(LatePolicy::kExtrapolate));
    Resume(arm, resumed);
    EXPECT_EQ(resumed.positions(), arm.positions());
    // What is late for one is late for the other.
    for (Driven* one : {&arm, &resumed}) {
      EXPECT_THAT(one->Send(11, 5 * kFrame),
                  Fails(absl::StatusCode::kOutOfRange, "is late"))
          << last;
    }
    for (int i = last + 1; i <= last + 30; ++i) {
      ASSERT_EQ(arm.Send(i), absl::OkStatus());
      ASSERT_EQ(resumed.Send(i), absl::OkStatus());
      ASSERT_EQ(arm.positions(), resumed.positions()) << last << ", " << i;
    }
  }
}

TEST_F(SessionFillResumeTest, ASilentSourceStillComesToRestElsewhere) {
  Driven arm(Filling(LatePolicy::kExtrapolate));
  SendTen(arm);
  ASSERT_EQ(arm.Fill(11 * kFrame), absl::OkStatus());
  Driven resumed(Filling(LatePolicy::kExtrapolate));
  Resume(arm, resumed);
  absl::Duration before = arm.filled_at();
  int count = 0;
  do {
    ASSERT_LT(++count, 100);
    ASSERT_EQ(arm.Fill((11 + count) * kFrame), absl::OkStatus());
    // The other machine's clock is years ahead.
    ASSERT_EQ(resumed.Fill(absl::Hours(20000) + count * kFrame),
              absl::OkStatus());
    EXPECT_EQ(resumed.filled_at() - before, kFrame);
    before = resumed.filled_at();
    ASSERT_EQ(resumed.state(), arm.state());
    // Up to the rounding of times.
    ASSERT_LT((resumed.positions() - arm.positions()).norm(), 1e-4);
  } while (!resumed.solved().live->is_settled);
  EXPECT_TRUE(arm.solved().live->is_settled);
  EXPECT_GT(count, 2) << "nothing was left to go on with";
}

TEST_F(SessionFillResumeTest, MemoryIsAsBeforeWithoutTheOption) {
  ConditioningOptions plain = Filling(LatePolicy::kExtrapolate);
  plain.fill_interval_s = 0;
  Driven arm(plain);
  Driven filling(Filling(LatePolicy::kExtrapolate));
  SendTen(arm);
  SendTen(filling);
  // With it: the newest time, and that nothing was filled.
  EXPECT_EQ(filling->Snapshot().memory.size(),
            arm->Snapshot().memory.size() + 4);
  EXPECT_EQ(arm.positions(), filling.positions());
}

}  // namespace
}  // namespace gelenk::server
