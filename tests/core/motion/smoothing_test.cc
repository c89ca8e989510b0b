#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "gelenk/math/rotation.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/hampel.h"
#include "gelenk/motion/low_pass.h"
#include "gelenk/motion/smoother.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/allocation_count.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::gelenk::testing::AllocationCount;
using ::gelenk::testing::Fails;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomRotation;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RandomVector;
using ::gelenk::testing::RandomVelocity;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kPi = std::numbers::pi;
constexpr double kFrame_s = 0.01;
constexpr absl::StatusCode kBad = absl::StatusCode::kInvalidArgument;

std::shared_ptr<const Skeleton> OneJoint(JointType type) {
  Joint joint;
  joint.id = "joint";
  joint.type = type;
  return SkeletonBuilder().AddJoint(joint).Build().value();
}

// Rotations about +Y by angles, as frames of a ball.
Eigen::MatrixXd Turning(const std::vector<double>& angles_rad) {
  Eigen::MatrixXd frames(4, angles_rad.size());
  for (size_t i = 0; i < angles_rad.size(); ++i) {
    frames.col(i) = ExpRotation({0, angles_rad[i], 0}).coeffs();
  }
  return frames;
}

double AngleAboutY(const Eigen::MatrixXd& frames, int i) {
  return LogRotation(QuaternionXyzw(frames.col(i).data())).y();
}

std::vector<double> Wave(double hz, double size, int count) {
  std::vector<double> wave(count);
  for (int i = 0; i < count; ++i) {
    wave[i] = size * std::sin(2 * kPi * hz * i * kFrame_s);
  }
  return wave;
}

TEST(LowPassTest, KeepsConstantsAndSteadyTurns) {
  Random random(1);
  const auto skeleton = RandomSkeleton(random);
  const Eigen::MatrixXd still = RandomPose(random, *skeleton).replicate(1, 100);
  EXPECT_LT((LowPass(*skeleton, still, kFrame_s, 5).value() - still)
                .cwiseAbs()
                .maxCoeff(),
            1e-13);
  std::vector<double> turn(300);
  for (int i = 0; i < 300; ++i) turn[i] = 5.0 * i * kFrame_s;
  const Eigen::MatrixXd turning = Turning(turn);
  const Eigen::MatrixXd smooth =
      LowPass(*OneJoint(JointType::kSpherical), turning, kFrame_s, 3).value();
  for (int i = 0; i < 300; ++i) {
    EXPECT_LT(AngleBetween(QuaternionXyzw(smooth.col(i).data()),
                           QuaternionXyzw(turning.col(i).data())),
              1e-3)
        << i;
  }
}

// Of a wave: gain by the formula of Butterworth, and no delay.
TEST(LowPassTest, HasTheGainOfTheBooksAndNoDelay) {
  const double cutoff_hz = 4;
  for (double hz : {1.0, 4.0, 8.0}) {
    const std::vector<double> wave = Wave(hz, 0.5, 800);
    const Eigen::MatrixXd smooth = LowPass(*OneJoint(JointType::kSpherical),
                                           Turning(wave), kFrame_s, cutoff_hz)
                                       .value();
    double in_phase = 0, out_of_phase = 0;
    for (int i = 200; i < 600; ++i) {  // Whole periods, far from the ends.
      const double phase = 2 * kPi * hz * i * kFrame_s;
      in_phase += AngleAboutY(smooth, i) * std::sin(phase) / 200;
      out_of_phase += AngleAboutY(smooth, i) * std::cos(phase) / 200;
    }
    const double ratio =
        std::tan(kPi * hz * kFrame_s) / std::tan(kPi * cutoff_hz * kFrame_s);
    const double gain =
        1 / (1 + (std::numbers::sqrt2 - 1) * std::pow(ratio, 4));
    EXPECT_NEAR(in_phase / 0.5, gain, 1e-3) << hz;
    EXPECT_NEAR(out_of_phase, 0, 1e-3) << hz;
  }
}

// Numbers and rotations about one axis are filtered alike.
TEST(LowPassTest, RotationsAboutOneAxisAreNumbers) {
  Random random(2);
  std::vector<double> noise(200);
  for (double& angle : noise) {
    angle = testing::Uniform(random, -0.7, 0.7);
  }
  const Eigen::MatrixXd numbers =
      LowPass(*OneJoint(JointType::kRevolute),
              Eigen::Map<const Eigen::RowVectorXd>(noise.data(), 200), kFrame_s,
              6)
          .value();
  const Eigen::MatrixXd rotations =
      LowPass(*OneJoint(JointType::kSpherical), Turning(noise), kFrame_s, 6)
          .value();
  for (int i = 0; i < 200; ++i) {
    EXPECT_NEAR(AngleAboutY(rotations, i), numbers(0, i), 1e-12);
  }
}

// A turn so fast that the filter is more than half a turn behind it, at either
// end of a clip and in its middle: still the filter of the books.
TEST(LowPassTest, FastTurnsKeepTheirWayRound) {
  constexpr int kCount = 80;
  for (double turn_deg : {60, 107, 140, 175}) {
    for (int frames_of_turn : {1, 2, 4, 8}) {
      for (int start : {0, 40, kCount - 1 - frames_of_turn}) {
        std::vector<double> angles(kCount);
        for (int i = 0; i < kCount; ++i) {
          angles[i] = turn_deg * kPi / 180 *
                      std::clamp((i - start) / (1.0 * frames_of_turn), 0., 1.);
        }
        const Eigen::MatrixXd numbers =
            LowPass(*OneJoint(JointType::kRevolute),
                    Eigen::Map<const Eigen::RowVectorXd>(angles.data(), kCount),
                    kFrame_s, 5)
                .value();
        const Eigen::MatrixXd rotations =
            LowPass(*OneJoint(JointType::kSpherical), Turning(angles), kFrame_s,
                    5)
                .value();
        for (int i = 0; i < kCount; ++i) {
          EXPECT_LT(AngleBetween(QuaternionXyzw(rotations.col(i).data()),
                                 ExpRotation({0, numbers(0, i), 0})),
                    1e-6)
              << turn_deg << " in " << frames_of_turn << " at " << start;
        }
      }
    }
  }
}

// By the sum of the magnitudes of its impulse response the filter cannot turn
// much faster than what goes in; the ends of a clip are no exception.
TEST(LowPassTest, TurnsNoFasterThanTheMotion) {
  Random random(6);
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::MatrixXd frames(4, 60);
    Eigen::Quaterniond q = RandomRotation(random);
    const double size = trial % 2 == 0 ? 0.5 : 1.5;
    Eigen::Vector3d velocity = RandomVector(random, size);
    double fastest = 0;
    for (int i = 0; i < 60; ++i) {
      frames.col(i) = q.coeffs();
      velocity = 0.7 * velocity + 0.3 * RandomVector(random, size);
      const Eigen::Quaterniond next = (q * ExpRotation(velocity)).normalized();
      if (i < 59) fastest = std::max(fastest, AngleBetween(q, next));
      q = next;
    }
    const Eigen::MatrixXd smooth =
        LowPass(*OneJoint(JointType::kSpherical), frames, kFrame_s, 9).value();
    for (int i = 1; i < 60; ++i) {
      EXPECT_LT(AngleBetween(QuaternionXyzw(smooth.col(i - 1).data()),
                             QuaternionXyzw(smooth.col(i).data())),
                1.17 * fastest)
          << trial << " at " << i;
    }
  }
}

// No axis and no frame is special, from either side.
TEST(LowPassTest, TurningTheMotionTurnsTheResult) {
  Random random(3);
  const auto ball = OneJoint(JointType::kSpherical);
  Eigen::MatrixXd frames(4, 100), turned(4, 100);
  const Eigen::Quaterniond left = RandomRotation(random);
  const Eigen::Quaterniond right = RandomRotation(random);
  Eigen::Quaterniond q = RandomRotation(random);
  for (int i = 0; i < 100; ++i) {
    q = (q * ExpRotation(RandomVector(random, 0.3))).normalized();
    frames.col(i) = q.coeffs();
    turned.col(i) = (left * q * right).coeffs();
  }
  const Eigen::MatrixXd smooth = LowPass(*ball, frames, kFrame_s, 8).value();
  const Eigen::MatrixXd also = LowPass(*ball, turned, kFrame_s, 8).value();
  for (int i = 0; i < 100; ++i) {
    EXPECT_LT(AngleBetween(left * QuaternionXyzw(smooth.col(i).data()) * right,
                           QuaternionXyzw(also.col(i).data())),
              1e-12);
  }
}

TEST(LowPassTest, ClipsKeepTheirTimesAndShortOnesStand) {
  const auto ball = OneJoint(JointType::kSpherical);
  const MotionClip clip = ClipFromFrames(ball, Turning(Wave(1, 1, 50)),
                                         {.name = "w", .frame_time_s = 0.01})
                              .value();
  const MotionClip smooth = LowPassClip(clip, 6).value();
  EXPECT_EQ(smooth.duration_s(), clip.duration_s());
  EXPECT_EQ(smooth.name(), "w");
  EXPECT_TRUE(LowPass(*ball, Turning({1}), kFrame_s, 5).ok());
  EXPECT_TRUE(LowPass(*ball, Turning({1, 1.1}), kFrame_s, 5).ok());
}

TEST(LowPassTest, RefusesCutoffsThatItCannotHave) {
  const auto ball = OneJoint(JointType::kSpherical);
  const Eigen::MatrixXd frames = Turning({0, 1, 2});
  EXPECT_TRUE(LowPass(*ball, frames, kFrame_s, 39).ok());
  for (double cutoff_hz : {0.0, -1.0, 40.5, std::nan("")}) {
    EXPECT_THAT(LowPass(*ball, frames, kFrame_s, cutoff_hz).status(),
                Fails(kBad, "cutoff_hz"));
  }
  EXPECT_THAT(LowPass(*ball, frames, 0, 5).status(),
              Fails(kBad, "frame_time_s"));
  EXPECT_THAT(LowPass(*ball, Eigen::MatrixXd::Zero(3, 3), kFrame_s, 5).status(),
              Fails(kBad, "want 4 numbers each, got 3"));
}

MotionClip BallClip(const std::vector<double>& angles_rad) {
  return ClipFromFrames(OneJoint(JointType::kSpherical), Turning(angles_rad),
                        {.frame_time_s = kFrame_s})
      .value();
}

TEST(HampelTest, ReplacesAnOutlierAndNothingElse) {
  std::vector<double> wave = Wave(1, 1, 100);
  const double right = wave[40];
  wave[40] += 1.5;
  const HampelResult result = RejectOutliers(BallClip(wave)).value();
  ASSERT_THAT(result.replaced, SizeIs(1));
  EXPECT_EQ(result.replaced[0].frame, 40);
  const Eigen::MatrixXd frames = FramesFromClip(result.clip).value();
  EXPECT_NEAR(AngleAboutY(frames, 40), right, 0.002);
  EXPECT_EQ(AngleAboutY(frames, 41), AngleAboutY(Turning(wave), 41));
}

TEST(HampelTest, TwoOutliersInARowAreBridged) {
  std::vector<double> wave = Wave(0.5, 1, 100);
  const double right = wave[51];
  wave[50] += 2;
  wave[51] += 2.2;
  const HampelResult result = RejectOutliers(BallClip(wave)).value();
  EXPECT_THAT(result.replaced, SizeIs(2));
  EXPECT_NEAR(AngleAboutY(FramesFromClip(result.clip).value(), 51), right,
              0.01);
}

TEST(HampelTest, LetsMotionAndNoiseBelowTheFloorPass) {
  EXPECT_THAT(RejectOutliers(BallClip(Wave(2, 1.5, 200)))->replaced, IsEmpty());
  std::vector<double> nearly(60, 0);
  nearly[30] = 0.029;
  EXPECT_THAT(RejectOutliers(BallClip(nearly))->replaced, IsEmpty());
  nearly[30] = 0.031;
  EXPECT_THAT(RejectOutliers(BallClip(nearly))->replaced, SizeIs(1));
  EXPECT_THAT(RejectOutliers(BallClip(nearly), {.reach = 0}).status(),
              Fails(kBad, "reach: want 1 to 8, got 0"));
  EXPECT_THAT(RejectOutliers(BallClip(nearly), {.sigmas = -1}).status(),
              Fails(kBad, "sigmas"));
}

// Output angles of a live smoother.
std::vector<double> Live(Smoother& smoother,
                         const std::vector<double>& angles) {
  std::vector<double> smooth;
  Eigen::VectorXd out(4);
  const Eigen::MatrixXd frames = Turning(angles);
  for (int i = 0; i < frames.cols(); ++i) {
    if (smoother.Push(i * kFrame_s, frames.col(i), out)) {
      smooth.push_back(LogRotation(QuaternionXyzw(out.data())).y());
    }
  }
  return smooth;
}

TEST(SmootherTest, SaysHowLateItIs) {
  std::vector<double> ramp(300);
  for (int i = 0; i < 300; ++i) ramp[i] = 1.0 * i * kFrame_s;  // 1 rad/s
  for (const SmootherOptions& options :
       {SmootherOptions{.kind = SmootherOptions::Kind::kNone},
        SmootherOptions{.kind = SmootherOptions::Kind::kExponential,
        .time_constant_s = 0.08},
        SmootherOptions{.kind = SmootherOptions::Kind::kOneEuro,
        .min_cutoff_hz = 1.5},
        SmootherOptions{.kind = SmootherOptions::Kind::kOneEuro,
        .hampel = HampelOptions{.reach = 2}}}) {
    Smoother smoother =
        Smoother::Create(OneJoint(JointType::kSpherical), options).value();
    const std::vector<double> smooth = Live(smoother, ramp);
    // At 1 rad/s the lag in rad is the lag in s.
    EXPECT_NEAR(ramp.back() - smooth.back(), smoother.latency_s(), 1e-3);
  }
}

TEST(SmootherTest, ExponentialLagsByItsTimeConstant) {
  Smoother smoother =
      Smoother::Create(
          OneJoint(JointType::kSpherical),
          {.kind = SmootherOptions::Kind::kExponential, .time_constant_s = 0.1})
          .value();
  const std::vector<double> step(40, 1.0);
  Eigen::VectorXd out(4);
  smoother.Push(-kFrame_s, Turning({0}).col(0), out);
  const std::vector<double> smooth = Live(smoother, step);
  for (int i = 0; i < 40; ++i) {
    EXPECT_NEAR(smooth[i], 1 - std::exp(-(i + 1) * kFrame_s / 0.1), 1e-12);
  }
}

TEST(SmootherTest, OneEuroStillsTremorAndFollowsHaste) {
  const auto make = [] {
    return Smoother::Create(OneJoint(JointType::kSpherical),
                            {.min_cutoff_hz = 1, .speed_coefficient = 2})
        .value();
  };
  Smoother at_rest = make();
  const std::vector<double> tremor = Live(at_rest, Wave(10, 0.005, 200));
  EXPECT_LT(*std::max_element(tremor.begin() + 100, tremor.end()), 0.001);
  Smoother in_haste = make();
  std::vector<double> ramp(200);
  for (int i = 0; i < 200; ++i) ramp[i] = 10 * i * kFrame_s;
  Live(in_haste, ramp);
  EXPECT_LT(in_haste.latency_s(), 0.01);
  EXPECT_NEAR(at_rest.latency_s(), 1 / (2 * kPi), 0.06);
}

TEST(SmootherTest, OutliersDoNotComeThrough) {
  Smoother smoother = Smoother::Create(OneJoint(JointType::kSpherical),
                                       {.kind = SmootherOptions::Kind::kNone,
                                        .hampel = HampelOptions{.reach = 3}})
                          .value();
  std::vector<double> wave = Wave(1, 0.5, 80);
  const double right = wave[40];
  wave[40] = 2.5;
  const std::vector<double> smooth = Live(smoother, wave);
  ASSERT_THAT(smooth, SizeIs(77));
  EXPECT_NEAR(smooth[40], right, 0.002);
  EXPECT_NEAR(smoother.latency_s(), 3 * kFrame_s, 1e-12);
}

TEST(SmootherTest, LeavesLatePosesOutAndStartsAnew) {
  Smoother smoother =
      Smoother::Create(OneJoint(JointType::kSpherical), {}).value();
  Eigen::VectorXd out(4);
  const Eigen::MatrixXd frames = Turning({0, 1});
  EXPECT_TRUE(smoother.Push(1, frames.col(0), out));
  EXPECT_FALSE(smoother.Push(1, frames.col(1), out));
  EXPECT_FALSE(smoother.Push(std::nan(""), frames.col(1), out));
  EXPECT_EQ(out, frames.col(0));
  smoother.Reset();
  EXPECT_TRUE(smoother.Push(0, frames.col(1), out));
  EXPECT_EQ(out, frames.col(1));
}

TEST(SmootherTest, RefusesOptionsListingAll) {
  const absl::Status status =
      Smoother::Create(OneJoint(JointType::kSpherical),
                       {.time_constant_s = -1,
                        .min_cutoff_hz = 0,
                        .speed_coefficient = std::nan(""),
                        .hampel = HampelOptions{.reach = 9}})
          .status();
  for (const char* words : {"time_constant_s", "min_cutoff_hz",
                            "speed_coefficient", "hampel.reach"}) {
    EXPECT_THAT(status, Fails(kBad, words));
  }
}

TEST(SmootherTest, AllocatesNothing) {
  Random random(4);
  const auto skeleton = RandomSkeleton(random);
  for (auto kind :
       {SmootherOptions::Kind::kNone, SmootherOptions::Kind::kExponential,
        SmootherOptions::Kind::kOneEuro}) {
    Smoother smoother =
        Smoother::Create(skeleton, {.kind = kind, .hampel = HampelOptions{}})
            .value();
    Eigen::VectorXd pose = RandomPose(random, *skeleton), out = pose;
    const Eigen::VectorXd velocity = RandomVelocity(random, *skeleton, 0.01);
    const int before = AllocationCount();
    for (int i = 0; i < 100; ++i) {
      Integrate(*skeleton, pose, velocity, pose);
      smoother.Push(0.01 * i, pose, out);
    }
    EXPECT_EQ(AllocationCount() - before, 0);
  }
}

}  // namespace
}  // namespace gelenk
