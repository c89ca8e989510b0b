#include "gelenk/motion/sampler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gelenk/math/rotation.h"
#include "gelenk/motion/clip_frames.h"
#include "tests/testing/allocation_count.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::AllocationCount;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomRotation;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RandomVector;
using ::gelenk::testing::Uniform;

constexpr Interpolation kAll[] = {Interpolation::kStep, Interpolation::kLinear,
                                  Interpolation::kCubicSpline,
                                  Interpolation::kCatmullRom};
// Some ten operations on numbers near 1.
constexpr double kRounding = 1e-13;

std::shared_ptr<const Skeleton> OneJoint(JointType type) {
  Joint joint;
  joint.id = "joint";
  joint.type = type;
  return SkeletonBuilder().AddJoint(joint).Build().value();
}

std::shared_ptr<const Skeleton> Ball() {
  return OneJoint(JointType::kSpherical);
}

std::shared_ptr<const Skeleton> Slider() {
  return OneJoint(JointType::kPrismatic);
}

// Uneven keys on every part of a random skeleton.
MotionClip RandomClip(Random& random,
                      const std::shared_ptr<const Skeleton>& skeleton,
                      Interpolation interpolation, int keys,
                      ClipProperties properties = {}) {
  std::vector<JointTrack> tracks;
  for (const PosePart& part : PosePartsOf(*skeleton)) {
    JointTrack track{
        .joint = part.joint, .kind = part.kind, .interpolation = interpolation};
    track.values.resize(part.position_count, keys);
    for (int key = 0; key < keys; ++key) {
      track.times_s.push_back(
          key == 0 ? 0 : track.times_s.back() + Uniform(random, 0.1, 0.5));
      track.values.col(key) =
          RandomPose(random, *skeleton)
              .segment(part.position_offset, part.position_count);
    }
    if (interpolation == Interpolation::kCubicSpline) {
      track.in_tangents = Eigen::MatrixXd::Random(part.position_count, keys);
      track.out_tangents = Eigen::MatrixXd::Random(part.position_count, keys);
    }
    tracks.push_back(std::move(track));
  }
  return MotionClip::Create(skeleton, std::move(tracks), std::move(properties))
      .value();
}

MotionClip BallClip(Interpolation interpolation, std::vector<double> times_s,
                    const std::vector<Eigen::Quaterniond>& rotations,
                    ClipProperties properties = {}) {
  JointTrack track{.joint = 0, .interpolation = interpolation};
  track.times_s = std::move(times_s);
  track.values.resize(4, rotations.size());
  for (size_t i = 0; i < rotations.size(); ++i) {
    track.values.col(i) = rotations[i].coeffs();
  }
  return MotionClip::Create(Ball(), {track}, std::move(properties)).value();
}

Eigen::VectorXd At(Sampler& sampler, double time_s) {
  Eigen::VectorXd positions(sampler.clip().skeleton()->position_count());
  sampler.Sample(time_s, positions);
  return positions;
}

Eigen::Quaterniond RotationAt(Sampler& sampler, double time_s) {
  return QuaternionXyzw(At(sampler, time_s).data());
}

// By a symmetric difference.
Eigen::Vector3d AngularVelocity(Sampler& sampler, double time_s) {
  constexpr double kStep_s = 1e-6;
  return LogRotation(RotationAt(sampler, time_s - kStep_s).conjugate() *
                     RotationAt(sampler, time_s + kStep_s)) /
         (2 * kStep_s);
}

TEST(SamplerTest, KeysAreMetExactly) {
  Random random(1);
  for (Interpolation interpolation : kAll) {
    const auto skeleton = RandomSkeleton(random);
    const MotionClip clip = RandomClip(random, skeleton, interpolation, 7);
    Sampler sampler(clip);
    for (int i = 0; i < clip.track_count(); ++i) {
      const JointTrack& track = clip.track(i);
      const PosePart& part = clip.curve(i).part();
      for (int key = 0; key < track.key_count(); ++key) {
        EXPECT_EQ(At(sampler, track.times_s[key])
                      .segment(part.position_offset, part.position_count),
                  track.values.col(key))
            << InterpolationName(interpolation) << ", key " << key;
      }
    }
  }
}

TEST(SamplerTest, IsContinuousAndUnitEverywhere) {
  Random random(2);
  for (Interpolation interpolation : kAll) {
    const auto skeleton = RandomSkeleton(random);
    Sampler sampler(RandomClip(random, skeleton, interpolation, 6));
    Eigen::VectorXd before = At(sampler, 0);
    const double end_s = sampler.clip().duration_s();
    for (int i = 1; i <= 2000; ++i) {
      Eigen::VectorXd now = At(sampler, end_s * i / 2000);
      ASSERT_TRUE(CheckPositions(*skeleton, now).ok());
      Eigen::VectorXd change(skeleton->velocity_count());
      Difference(*skeleton, before, now, change);
      // Steps of 1 ms at a few turns in a tenth of a second.
      if (interpolation != Interpolation::kStep) {
        ASSERT_LT(change.cwiseAbs().maxCoeff(), 0.2) << i;
      }
      before = now;
    }
  }
}

TEST(SamplerTest, AnyOrderOfTimesGivesTheSameBits) {
  Random random(3);
  for (Interpolation interpolation : kAll) {
    const auto skeleton = RandomSkeleton(random);
    const MotionClip clip = RandomClip(random, skeleton, interpolation, 9);
    Sampler used(clip);
    for (int i = 0; i < 200; ++i) {
      const double time_s = Uniform(random, -0.5, clip.duration_s() + 0.5);
      Sampler fresh(clip);
      EXPECT_EQ(At(used, time_s), At(fresh, time_s));
    }
  }
}

TEST(SamplerTest, StepHoldsTheKeyBefore) {
  JointTrack track{.joint = 0,
                   .kind = PosePartKind::kNumbers,
                   .interpolation = Interpolation::kStep,
                   .times_s = {1, 2, 3}};
  track.values = Eigen::RowVector3d(10, 20, 30);
  Sampler sampler(MotionClip::Create(Slider(), {track}).value());
  EXPECT_EQ(At(sampler, 0)[0], 10);
  EXPECT_EQ(At(sampler, std::nextafter(2.0, 0.0))[0], 10);
  EXPECT_EQ(At(sampler, 2)[0], 20);
  EXPECT_EQ(At(sampler, 99)[0], 30);
}

TEST(SamplerTest, SlerpTurnsAtConstantSpeedTheShorterWay) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Quaterniond a = RandomRotation(random);
    const Eigen::Quaterniond b = RandomRotation(random);
    Sampler sampler(BallClip(Interpolation::kLinear, {0, 2}, {a, b}));
    const double whole = AngleBetween(a, b);
    for (double u : {0.1, 0.25, 0.5, 0.9}) {
      const Eigen::Quaterniond q = RotationAt(sampler, 2 * u);
      EXPECT_NEAR(AngleBetween(a, q), u * whole, kRounding);
      EXPECT_NEAR(AngleBetween(q, b), (1 - u) * whole, kRounding);
    }
  }
}

// Angles so small that an arc cosine would lose them.
TEST(SamplerTest, SlerpOfTinyAngles) {
  for (double angle : {1e-4, 1e-7, 1e-9, 1e-12, 0.0}) {
    const Eigen::Quaterniond b(
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()));
    Sampler sampler(BallClip(Interpolation::kLinear, {0, 1},
                             {Eigen::Quaterniond::Identity(), b}));
    EXPECT_NEAR(RotationAt(sampler, 0.25).x(), 0.125 * angle, 1e-9 * angle);
  }
}

// glTF 2.0, appendix C: the cubic by its formula, in another order of
// operations.
TEST(SamplerTest, CubicSplineIsThatOfGltf) {
  Random random(5);
  const auto skeleton = RandomSkeleton(random);
  const MotionClip clip =
      RandomClip(random, skeleton, Interpolation::kCubicSpline, 5);
  Sampler sampler(clip);
  for (int i = 0; i < clip.track_count(); ++i) {
    const JointTrack& track = clip.track(i);
    const PosePart& part = clip.curve(i).part();
    for (int key = 0; key + 1 < track.key_count(); ++key) {
      const double td = track.times_s[key + 1] - track.times_s[key];
      for (double t : {0.125, 0.5, 0.75}) {
        const double t2 = std::pow(t, 2), t3 = std::pow(t, 3);
        Eigen::VectorXd expected =
            (2 * t3 - 3 * t2 + 1) * track.values.col(key) +
            td * (t3 - 2 * t2 + t) * track.out_tangents.col(key) +
            (-2 * t3 + 3 * t2) * track.values.col(key + 1) +
            td * (t3 - t2) * track.in_tangents.col(key + 1);
        if (track.kind == PosePartKind::kRotation) expected.normalize();
        EXPECT_LT((At(sampler, track.times_s[key] + t * td)
                       .segment(part.position_offset, part.position_count) -
                   expected)
                      .norm(),
                  1e-12);
      }
    }
  }
}

TEST(SamplerTest, CatmullRomThroughAParabolaIsTheParabola) {
  JointTrack track{.joint = 0,
                   .kind = PosePartKind::kNumbers,
                   .interpolation = Interpolation::kCatmullRom,
                   .times_s = {0, 0.3, 1, 1.2, 2.5}};
  track.values.resize(1, 5);
  for (int i = 0; i < 5; ++i) {
    track.values(0, i) = 3 * track.times_s[i] * track.times_s[i] - 1;
  }
  Sampler sampler(MotionClip::Create(Slider(), {track}).value());
  for (double t : {0.31, 0.7, 1.1}) {  // Both tangents from two neighbours.
    EXPECT_NEAR(At(sampler, t)[0], 3 * t * t - 1, kRounding);
  }
}

TEST(SamplerTest, CatmullRomKeepsAConstantTurn) {
  const Eigen::Vector3d speed(0.5, -1.5, 1);
  std::vector<Eigen::Quaterniond> rotations;
  const std::vector<double> times_s = {0, 0.2, 1.3, 1.4, 2};
  for (double t : times_s) rotations.push_back(ExpRotation(t * speed));
  Sampler sampler(BallClip(Interpolation::kCatmullRom, times_s, rotations));
  for (double t : {0.1, 0.5, 1.35, 1.9}) {
    EXPECT_LT(AngleBetween(RotationAt(sampler, t), ExpRotation(t * speed)),
              kRounding);
  }
}

// Also on very uneven keys, where squad is not.
TEST(SamplerTest, CatmullRomTurnsSmoothly) {
  Random random(6);
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<double> times_s = {0, 0.1, 1, 1.3, 3};
    std::vector<Eigen::Quaterniond> rotations = {RandomRotation(random)};
    for (int i = 1; i < 5; ++i) {
      rotations.push_back(rotations.back() *
                          ExpRotation(RandomVector(random, 1)));
    }
    Sampler sampler(BallClip(Interpolation::kCatmullRom, times_s, rotations));
    for (int key = 1; key < 4; ++key) {
      // Twice the step of the difference on either side.
      const Eigen::Vector3d before =
          AngularVelocity(sampler, times_s[key] - 2e-6);
      const Eigen::Vector3d after =
          AngularVelocity(sampler, times_s[key] + 2e-6);
      EXPECT_LT((before - after).norm(), 1e-2 * (1 + before.norm())) << key;
    }
  }
}

TEST(SamplerTest, LoopsOfACycleAreContinuous) {
  Random random(7);
  for (Interpolation interpolation :
       {Interpolation::kLinear, Interpolation::kCatmullRom}) {
    const auto skeleton = RandomSkeleton(random);
    Sampler sampler(
        RandomClip(random, skeleton, interpolation, 5, {.seam_s = 0.4}),
        PlaybackMode::kLoop);
    const double period_s = sampler.clip().period_s();
    Eigen::VectorXd change(skeleton->velocity_count());
    for (int round = -2; round <= 2; ++round) {
      for (double at_s : {0.0, sampler.clip().duration_s()}) {
        const double time_s = round * period_s + at_s;
        Difference(*skeleton, At(sampler, time_s - 1e-7),
                   At(sampler, time_s + 1e-7), change);
        EXPECT_LT(change.cwiseAbs().maxCoeff(), 1e-5);
      }
    }
  }
}

TEST(SamplerTest, ACycleThatEndsAsItBeginsTurnsSmoothlyThroughItsSeam) {
  const auto turn = [](double angle) {
    return Eigen::Quaterniond(
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  };
  Sampler sampler(
      BallClip(Interpolation::kCatmullRom, {0, 0.5, 0.8, 2},
               {turn(0), turn(1), turn(0.3), turn(0)}, {.seam_s = 0}),
      PlaybackMode::kLoop);
  EXPECT_LT(
      (AngularVelocity(sampler, 2 - 2e-6) - AngularVelocity(sampler, 2 + 2e-6))
          .norm(),
      1e-3);
  EXPECT_GT(AngularVelocity(sampler, 2.0).norm(), 0.1);
}

TEST(SamplerTest, LoopsComeRoundAlsoBackwards) {
  Random random(8);
  const auto skeleton = RandomSkeleton(random);
  Sampler sampler(RandomClip(random, skeleton, Interpolation::kLinear, 5),
                  PlaybackMode::kLoop);
  const double period_s = sampler.clip().period_s();
  EXPECT_EQ(sampler.ClipTime(-1e-300), 0);
  Eigen::VectorXd change(skeleton->velocity_count());
  for (int round : {-3, 1, 7}) {
    Difference(*skeleton, At(sampler, 0.3), At(sampler, 0.3 + round * period_s),
               change);
    EXPECT_LT(change.cwiseAbs().maxCoeff(), 1e-11);
  }
}

TEST(SamplerTest, JointsWithoutTrackStayAtTheBase) {
  const Eigen::Vector4d base(0.6, 0, 0, 0.8);
  Sampler sampler(
      MotionClip::Create(Ball(), {}, {.base_positions = base}).value(),
      PlaybackMode::kLoop);
  EXPECT_EQ(At(sampler, 5), base);
}

TEST(SamplerTest, AllocatesNothing) {
  Random random(9);
  for (Interpolation interpolation : kAll) {
    for (PlaybackMode mode : {PlaybackMode::kClamp, PlaybackMode::kLoop}) {
      const auto skeleton = RandomSkeleton(random);
      Sampler sampler(
          RandomClip(random, skeleton, interpolation, 9, {.seam_s = 0.1}),
          mode);
      Eigen::VectorXd positions(skeleton->position_count());
      const int before = AllocationCount();
      for (int i = -100; i < 300; ++i) sampler.Sample(0.02 * i, positions);
      EXPECT_EQ(AllocationCount() - before, 0);
    }
  }
}

TEST(ClipFramesTest, ComeBackBitByBit) {
  Random random(10);
  for (Interpolation interpolation :
       {Interpolation::kStep, Interpolation::kLinear,
        Interpolation::kCatmullRom}) {
    const auto skeleton = RandomSkeleton(random);
    Eigen::MatrixXd frames(skeleton->position_count(), 200);
    for (int i = 0; i < frames.cols(); ++i) {
      frames.col(i) = RandomPose(random, *skeleton);
      if (i > 0) AlignHemispheres(*skeleton, frames.col(i - 1), frames.col(i));
    }
    const auto clip = ClipFromFrames(
        skeleton, frames, {.frame_time_s = 0.0083333}, interpolation);
    ASSERT_TRUE(clip.ok()) << clip.status();
    EXPECT_EQ(clip->properties().frame_time_s, 0.0083333);
    EXPECT_EQ(FramesFromClip(*clip).value(), frames);
    EXPECT_EQ(FramesFromClip(*clip, 2 * 0.0083333)->cols(), 100);
  }
}

TEST(ClipFramesTest, RefusesWhatIsMalformed) {
  Eigen::MatrixXd frames(4, 2);
  frames << 0, 0, 0, 0, 0, 0, 1, 1;
  const auto message = [&](double frame_time_s) {
    return std::string(
        ClipFromFrames(Ball(), frames, {.frame_time_s = frame_time_s})
            .status()
            .message());
  };
  EXPECT_EQ(message(1), "");
  EXPECT_THAT(message(0), ::testing::HasSubstr("frame_time_s"));
  frames(3, 1) = std::nan("");
  EXPECT_THAT(message(1), ::testing::HasSubstr("frames[1].positions[3]"));
  frames.resize(4, 0);
  EXPECT_THAT(message(1), ::testing::HasSubstr("got 0 of 4"));

  const MotionClip clip = BallClip(
      Interpolation::kLinear, {0, 1},
      {Eigen::Quaterniond::Identity(), Eigen::Quaterniond::Identity()});
  EXPECT_FALSE(FramesFromClip(clip, 0).ok());
  EXPECT_FALSE(FramesFromClip(clip, 1e-9).ok());
  EXPECT_FALSE(FramesFromClip(clip, std::nan("")).ok());
}

}  // namespace
}  // namespace gelenk
