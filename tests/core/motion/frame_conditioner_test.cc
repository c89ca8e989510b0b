#include "gelenk/motion/frame_conditioner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/testing/example_skeletons.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using testing::Fails;
using State = LiveStatus::State;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
constexpr double kFrameTime = 0.02;

// One angle that goes round.
std::shared_ptr<const Skeleton> Arm() {
  return testing::PlanarChain(Eigen::Vector3d::Zero(), {1});
}

Eigen::VectorXd At(double angle) { return Eigen::VectorXd::Constant(1, angle); }

ConditioningOptions Busy() {
  ConditioningOptions options;
  options.smoother.kind = SmootherOptions::Kind::kOneEuro;
  options.late_policy = LatePolicy::kExtrapolate;
  return options;
}

// Frame f of a motion from which some frames are missing.
double Play(int f, FrameConditioner& conditioner) {
  const double time = f * kFrameTime;
  if (f % 30 < 20) conditioner.Take(time, time, At(std::sin(3 * time)));
  Eigen::VectorXd used = At(0);
  conditioner.Sample(time, time, used);
  return used[0];
}

TEST(FrameConditionerTest, ByDefaultFramesAreUsedAsTheyCome) {
  auto conditioner = *FrameConditioner::Create(Arm(), {});
  for (int f = 0; f < 20; ++f) {
    EXPECT_EQ(Play(f, conditioner), std::sin(3 * (f * kFrameTime)));
  }
  EXPECT_EQ(conditioner.latency_s(), 0);
}

TEST(FrameConditionerTest, AJitterBufferSpacesFramesEvenly) {
  ConditioningOptions options;
  options.jitter_frames = 2;
  options.frame_interval_s = kFrameTime;
  auto conditioner = *FrameConditioner::Create(Arm(), options);
  Eigen::VectorXd used = At(0);
  for (int f = 0; f < 60; ++f) {
    const double time = f * kFrameTime;
    // Every third frame is late by most of a frame.
    const double arrival = 100 + time + (f % 3 == 1 ? 0.018 : 0);
    conditioner.Take(time, arrival, At(time));
    conditioner.Sample(time, arrival, used);
    if (f < 6) continue;
    EXPECT_NEAR(used[0], arrival - 100 - 2 * kFrameTime, 1e-6) << f;
  }
  EXPECT_DOUBLE_EQ(conditioner.latency_s(), 2 * kFrameTime);
}

TEST(FrameConditionerTest, StateGoesOver) {
  const auto skeleton = Arm();
  auto undisturbed = *FrameConditioner::Create(skeleton, Busy(), At(0));
  std::vector<double> angles;
  std::vector<std::vector<double>> states;
  for (int f = 0; f < 90; ++f) {
    angles.push_back(Play(f, undisturbed));
    states.push_back(StateOf(undisturbed));
  }
  for (int last = 0; last < 89; ++last) {
    auto other = *FrameConditioner::Create(skeleton, Busy(), At(0));
    Play(7, other);
    ASSERT_TRUE(RestoreState(states[last], other).ok());
    for (int f = last + 1; f < 90; ++f) {
      ASSERT_EQ(Play(f, other), angles[f]) << last << ", " << f;
    }
  }
}

TEST(FrameConditionerTest, NumbersThatAreNoStateChangeNothing) {
  auto conditioner = *FrameConditioner::Create(Arm(), Busy(), At(0));
  for (int f = 0; f < 25; ++f) Play(f, conditioner);
  const std::vector<double> state = StateOf(conditioner);
  for (size_t i = 0; i < state.size(); ++i) {
    std::vector<double> bad = state;
    bad[i] = std::numeric_limits<double>::infinity();
    EXPECT_THAT(RestoreState(bad, conditioner), Fails(kInvalid, "state["));
    bad.resize(i);
    EXPECT_THAT(RestoreState(bad, conditioner), Fails(kInvalid, "state"));
    EXPECT_EQ(StateOf(conditioner), state);
  }
}

TEST(FrameConditionerTest, BadOptionsAreNamed) {
  ConditioningOptions options;
  options.jitter_frames = kMaxJitterFrames + 1;
  EXPECT_THAT(FrameConditioner::Create(Arm(), options).status(),
              Fails(kInvalid, "jitter_buffer_frames: want 0 to 32, got 33"));
  options.jitter_frames = 1;
  EXPECT_THAT(FrameConditioner::Create(Arm(), options).status(),
              Fails(kInvalid, "frame_interval"));
  options = Busy();
  options.smoother.min_cutoff_hz = -1;
  options.ease_s = 0;
  const absl::Status status = FrameConditioner::Create(Arm(), options).status();
  EXPECT_THAT(status, Fails(kInvalid, "min_cutoff_hz"));
  EXPECT_THAT(status, Fails(kInvalid, "ease_s"));
}

}  // namespace
}  // namespace gelenk
