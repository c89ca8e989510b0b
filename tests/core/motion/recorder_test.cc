#include "gelenk/motion/recorder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/frame_log.h"
#include "gelenk/motion/sampler.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Fails;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeleton;

constexpr absl::StatusCode kBad = absl::StatusCode::kInvalidArgument;

TEST(RecorderTest, PosesComeBackAtTheirTimes) {
  Random random(1);
  const auto skeleton = RandomSkeleton(random);
  Recorder recorder(skeleton);
  const double times_s[] = {100, 100.2, 100.25, 103};
  Eigen::MatrixXd poses(skeleton->position_count(), 4);
  for (int i = 0; i < 4; ++i) {
    poses.col(i) = RandomPose(random, *skeleton);
    ASSERT_TRUE(recorder.Record(times_s[i], poses.col(i)).ok());
  }
  EXPECT_EQ(recorder.frame_count(), 4);
  EXPECT_EQ(recorder.duration_s(), 3);
  const MotionClip clip = recorder.ToClip("take").value();
  EXPECT_EQ(clip.name(), "take");
  EXPECT_EQ(clip.duration_s(), 3);
  EXPECT_EQ(clip.properties().frame_time_s, 0);
  Sampler sampler(clip);
  Eigen::VectorXd pose(skeleton->position_count());
  Eigen::VectorXd change(skeleton->velocity_count());
  for (int i = 0; i < 4; ++i) {
    sampler.Sample(times_s[i] - times_s[0], pose);
    Difference(*skeleton, poses.col(i), pose, change);
    EXPECT_LT(change.cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(RecorderTest, FindsTheRateOfEvenFrames) {
  Random random(2);
  const auto skeleton = RandomSkeleton(random);
  Recorder recorder(skeleton);
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(recorder.Record(i / 120.0, RandomPose(random, *skeleton)).ok());
  }
  const MotionClip clip = recorder.ToClip("").value();
  EXPECT_NEAR(clip.properties().frame_time_s, 1 / 120.0, 1e-12);
  EXPECT_EQ(FramesFromClip(clip)->cols(), 50);
}

TEST(RecorderTest, RefusesWithoutLosingWhatItHas) {
  Random random(3);
  const auto skeleton = RandomSkeleton(random);
  Recorder recorder(skeleton, 2);
  EXPECT_THAT(recorder.ToClip("").status(),
              Fails(absl::StatusCode::kFailedPrecondition, "nothing"));
  Eigen::VectorXd pose = RandomPose(random, *skeleton);
  ASSERT_TRUE(recorder.Record(1, pose).ok());
  EXPECT_THAT(recorder.Record(1, pose), Fails(kBad, "time_s"));
  EXPECT_THAT(recorder.Record(NAN, pose), Fails(kBad, "time_s"));
  EXPECT_THAT(recorder.Record(2, Eigen::VectorXd::Zero(1)),
              Fails(kBad, "positions"));
  pose[0] = NAN;
  EXPECT_THAT(recorder.Record(2, pose), Fails(kBad, "positions[0]"));
  EXPECT_EQ(recorder.frame_count(), 1);
  ASSERT_TRUE(recorder.Record(2, RandomPose(random, *skeleton)).ok());
  EXPECT_THAT(recorder.Record(3, RandomPose(random, *skeleton)),
              Fails(absl::StatusCode::kResourceExhausted, "at most 2"));
  EXPECT_TRUE(recorder.ToClip("").ok());
}

// A system with memory: each pose hangs on all inputs before.
struct Accumulator {
  double sum = 0.1;
  Eigen::VectorXd Step(double input) {
    sum = std::sin(3 * sum + input);
    return Eigen::VectorXd::Constant(1, sum);
  }
};

TEST(FrameLogTest, ReplaysBitByBitAndFindsTheFirstThatDiffers) {
  FrameLog<double> log(100);
  Accumulator live;
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(log.Append({.sequence_number = 2 * i,
                            .time_s = 0.1 * i,
                            .input = 0.3 * i,
                            .positions = live.Step(0.3 * i)})
                    .ok());
  }
  Accumulator again;
  EXPECT_EQ(log.Replay([&](const LoggedFrame<double>& frame) {
    return again.Step(frame.input);
  }),
            -1);
  Accumulator other;
  EXPECT_EQ(log.Replay([&](const LoggedFrame<double>& frame) {
    return other.Step(frame.sequence_number == 14 ? 9.0 : frame.input);
  }),
            7);
  Accumulator loose;
  EXPECT_EQ(
      log.Replay(
          [&](const LoggedFrame<double>& frame) {
            return Eigen::VectorXd(loose.Step(frame.input).array() + 1e-9);
          },
          1e-8),
      -1);
}

TEST(FrameLogTest, ASignOfZeroIsADifference) {
  FrameLog<int> log(1);
  ASSERT_TRUE(log.Append({.sequence_number = 1,
                          .input = 0,
                          .positions = Eigen::VectorXd::Constant(1, 0.0)})
                  .ok());
  const auto negative = [](const LoggedFrame<int>&) -> Eigen::VectorXd {
    return Eigen::VectorXd::Constant(1, -0.0);
  };
  EXPECT_EQ(log.Replay(negative), 0);
  EXPECT_EQ(log.Replay(negative, 1e-12), -1);
}

TEST(FrameLogTest, IsBoundedAndInOrder) {
  FrameLog<std::string> log(2);
  ASSERT_TRUE(
      log.Append({.sequence_number = 3, .input = "a", .positions = {}}).ok());
  EXPECT_THAT(log.Append({.sequence_number = 3, .input = "b", .positions = {}}),
              Fails(kBad, "more than the last, 3, got 3"));
  ASSERT_TRUE(
      log.Append({.sequence_number = 4, .input = "b", .positions = {}}).ok());
  EXPECT_THAT(log.Append({.sequence_number = 5, .input = "c", .positions = {}}),
              Fails(absl::StatusCode::kResourceExhausted, "at most 2"));
  EXPECT_EQ(log.frames().size(), 2);
}

}  // namespace
}  // namespace gelenk
