#include "gelenk/motion/live_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/allocation_count.h"
#include "tests/testing/random.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::gelenk::testing::AllocationCount;
using ::gelenk::testing::Fails;
using ::gelenk::testing::Random;
using ::gelenk::testing::Uniform;
using State = LiveStatus::State;

// Exact but for sums of times.
constexpr double kRounding = 1e-9;
// The sender's clock is so far behind, and the line takes so long.
constexpr double kOffset_s = 1000;
constexpr double kFrame_s = 0.02;

std::shared_ptr<const Skeleton> Hinge() {
  Joint joint;
  joint.id = "hinge";
  joint.type = JointType::kRevolute;
  return SkeletonBuilder().AddJoint(joint).Build().value();
}

LiveClock Make(LiveClockOptions options) {
  return LiveClock::Create(Hinge(), std::move(options)).value();
}

// Frame `i` of a motion at 1 rad/s, `late_s` later than the fastest.
bool Push(LiveClock& clock, int i, double late_s = 0) {
  const double capture_s = i * kFrame_s;
  return clock.Push(i, capture_s, capture_s + kOffset_s + late_s,
                    Eigen::VectorXd::Constant(1, capture_s));
}

double Show(LiveClock& clock, double now_s, LiveStatus& status) {
  Eigen::VectorXd positions = Eigen::VectorXd::Constant(1, -99);
  status = clock.Sample(now_s, positions);
  return positions[0];
}

TEST(ClockOffsetTest, IsTheRunningMinimum) {
  ClockOffset offset(7);
  EXPECT_FALSE(offset.offset_s().has_value());
  offset.Note(0, 100.3);
  offset.Note(1, 101.1);
  offset.Note(2, 102.4);
  EXPECT_NEAR(*offset.offset_s(), 100.1, kRounding);
  // A fast frame is forgotten after the window; a drift is followed.
  for (int i = 3; i < 14; ++i) offset.Note(i, i + 100.5);
  EXPECT_NEAR(*offset.offset_s(), 100.5, kRounding);
  offset.Note(20, 119.0);
  EXPECT_NEAR(*offset.offset_s(), 99.0, kRounding);
}

TEST(LiveClockTest, ABufferMakesJitteredFramesEven) {
  // The jitter and a frame: the next one is wanted, too.
  LiveClock clock = Make({.delay_s = 0.07});
  Random random(1);
  std::vector<double> late_s;
  for (int i = 0; i < 200; ++i) {
    late_s.push_back(i % 10 == 0 ? 0 : Uniform(random, 0, 0.045));
  }
  LiveStatus status;
  int next = 0;
  for (double now_s = kOffset_s + 0.2; now_s < kOffset_s + 3.5;
       now_s += 0.007) {
    while (next < 200 && next * kFrame_s + kOffset_s + late_s[next] <= now_s) {
      ASSERT_TRUE(Push(clock, next, late_s[next]));
      ++next;
    }
    // The motion as it was, 70 ms late.
    ASSERT_NEAR(Show(clock, now_s, status), now_s - kOffset_s - 0.07,
                kRounding);
    ASSERT_EQ(status.state, State::kPlaying);
    ASSERT_LE(status.age_s, 0.07 + kFrame_s + kRounding);
    ASSERT_GE(status.age_s, 0.07 - kRounding);
  }
  EXPECT_EQ(clock.late_count(), 0);
  EXPECT_EQ(clock.out_of_order_count(), 0);
}

TEST(LiveClockTest, WithoutDelayEachFrameIsShownAsItComes) {
  LiveClock clock = Make({});
  LiveStatus status;
  EXPECT_EQ(Show(clock, 5, status), -99);
  EXPECT_EQ(status.state, State::kEmpty);
  EXPECT_EQ(status.sequence_number, -1);
  for (int i = 0; i < 10; ++i) {
    Push(clock, i);
    EXPECT_NEAR(Show(clock, i * kFrame_s + kOffset_s, status), i * kFrame_s,
                kRounding);
    EXPECT_EQ(status.sequence_number, i);
    EXPECT_NEAR(status.age_s, 0, kRounding);
  }
}

TEST(LiveClockTest, HoldsTheLastFrame) {
  LiveClock clock = Make({.late_policy = LatePolicy::kHold});
  Push(clock, 0);
  Push(clock, 1);
  LiveStatus status;
  EXPECT_NEAR(Show(clock, kOffset_s + 0.5, status), kFrame_s, kRounding);
  EXPECT_EQ(status.state, State::kHolding);
  EXPECT_NEAR(status.age_s, 0.48, kRounding);
  EXPECT_TRUE(status.is_settled);
}

TEST(LiveClockTest, DropsWhatIsMissing) {
  LiveClock clock = Make({.late_policy = LatePolicy::kDrop});
  Push(clock, 0);
  Push(clock, 1);
  LiveStatus status;
  EXPECT_NEAR(Show(clock, kOffset_s + 2.4 * kFrame_s, status), kFrame_s,
              kRounding);
  EXPECT_EQ(status.state, State::kPlaying);
  EXPECT_FALSE(status.is_settled);
  EXPECT_EQ(Show(clock, kOffset_s + 2.6 * kFrame_s, status), -99);
  EXPECT_EQ(status.state, State::kEmpty);
  EXPECT_TRUE(status.is_settled);
}

TEST(LiveClockTest, ExtrapolatesThenEasesAndDoesNotPop) {
  LiveClock clock = Make({.late_policy = LatePolicy::kExtrapolate,
                          .max_extrapolation_s = 0.2,
                          .ease_s = 0.4,
                          .rest = Eigen::VectorXd::Constant(1, -1)});
  Push(clock, 0);
  Push(clock, 1);
  LiveStatus status;
  // The speed falls evenly: after 0.1 of 0.2 s it has gone 0.075.
  EXPECT_NEAR(Show(clock, kOffset_s + kFrame_s + 0.1, status), kFrame_s + 0.075,
              kRounding);
  EXPECT_EQ(status.state, State::kExtrapolating);
  EXPECT_NEAR(Show(clock, kOffset_s + kFrame_s + 0.2, status), kFrame_s + 0.1,
              kRounding);
  // Half of the way to rest.
  EXPECT_NEAR(Show(clock, kOffset_s + kFrame_s + 0.4, status),
              0.5 * (kFrame_s + 0.1) - 0.5, kRounding);
  EXPECT_EQ(status.state, State::kEasing);
  EXPECT_FALSE(status.is_settled);
  const double shown = Show(clock, kOffset_s + kFrame_s + 0.6 + 1e-6, status);
  EXPECT_NEAR(shown, -1, kRounding);
  EXPECT_TRUE(status.is_settled);
  // Frames come again: from there, smoothly, back to the motion.
  double before = shown;
  for (int step = 0; step <= 100; ++step) {
    const double now_s = kOffset_s + 0.64 + 0.006 * step;
    const int due =
        static_cast<int>(std::floor((now_s - kOffset_s) / kFrame_s));
    Push(clock, due);
    const double angle = Show(clock, now_s, status);
    EXPECT_LT(std::abs(angle - before), 0.06) << step;
    before = angle;
  }
  EXPECT_NEAR(before, 1.24, kFrame_s);
}

TEST(LiveClockTest, LeavesOutOfOrderFramesOutAndCounts) {
  LiveClock clock = Make({.delay_s = 0.02});
  EXPECT_TRUE(Push(clock, 5));
  EXPECT_FALSE(Push(clock, 5));
  EXPECT_FALSE(Push(clock, 4));
  EXPECT_FALSE(clock.Push(9, 0.01, 1000, Eigen::VectorXd::Zero(1)));
  EXPECT_FALSE(clock.Push(9, NAN, 1000, Eigen::VectorXd::Zero(1)));
  EXPECT_EQ(clock.out_of_order_count(), 4);
  EXPECT_TRUE(Push(clock, 6, 0.3));
  EXPECT_EQ(clock.late_count(), 1);
}

TEST(LiveClockTest, NeverRunsBackwards) {
  LiveClock clock = Make({.delay_s = 0.03});
  LiveStatus status;
  double before = -1;
  for (int i = 0; i < 100; ++i) {
    // Slow at first; then the line gets faster by 25 ms.
    Push(clock, i, i < 50 ? 0.025 : 0);
    const double shown = Show(clock, i * kFrame_s + kOffset_s + 0.026, status);
    EXPECT_GE(shown, before);
    before = shown;
  }
}

TEST(LiveClockTest, RefusesOptionsListingAll) {
  const absl::Status status =
      LiveClock::Create(Hinge(), {.delay_s = -1,
                                  .window_s = 0,
                                  .max_extrapolation_s = NAN,
                                  .ease_s = 0,
                                  .rest = Eigen::VectorXd::Zero(2),
                                  .capacity = 1})
          .status();
  for (const char* words : {"delay_s", "window_s", "max_extrapolation_s",
                            "ease_s", "rest", "capacity"}) {
    EXPECT_THAT(status, Fails(absl::StatusCode::kInvalidArgument, words));
  }
}

TEST(LiveClockTest, AllocatesNothing) {
  LiveClock clock = Make({.delay_s = 0.03,
                          .late_policy = LatePolicy::kExtrapolate,
                          .capacity = 4});
  Eigen::VectorXd pose = Eigen::VectorXd::Zero(1);
  const int before = AllocationCount();
  for (int i = 0; i < 200; ++i) {
    if (i % 50 < 40) clock.Push(i, 0.02 * i, 0.02 * i + 7, pose);
    clock.Sample(0.02 * i + 7.01, pose);
  }
  EXPECT_EQ(AllocationCount() - before, 0);
}

}  // namespace
}  // namespace gelenk
