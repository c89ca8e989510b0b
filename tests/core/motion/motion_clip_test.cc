#include "gelenk/motion/motion_clip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Fails;

constexpr absl::StatusCode kBad = absl::StatusCode::kInvalidArgument;

Joint JointBelow(const char* parent_id, const char* id, JointType type) {
  Joint joint;
  joint.id = id;
  joint.parent_id = parent_id;
  joint.type = type;
  return joint;
}

// A free root, a ball below it, a hinge below that and a mimic of the hinge.
std::shared_ptr<const Skeleton> Body() {
  Joint twin = JointBelow("hinge", "twin", JointType::kRevolute);
  twin.mimic = Mimic{"hinge", 1, 0};
  return SkeletonBuilder()
      .AddJoint(JointBelow("", "root", JointType::kFree))
      .AddJoint(JointBelow("root", "ball", JointType::kSpherical))
      .AddJoint(JointBelow("ball", "hinge", JointType::kRevolute))
      .AddJoint(std::move(twin))
      .Build()
      .value();
}

JointTrack Hinge(std::vector<double> times_s) {
  JointTrack track{.joint = 2, .kind = PosePartKind::kNumbers};
  track.values = Eigen::MatrixXd::Zero(1, times_s.size());
  track.times_s = std::move(times_s);
  return track;
}

absl::Status CreateWith(JointTrack track, ClipProperties properties = {}) {
  return MotionClip::Create(Body(), {std::move(track)}, std::move(properties))
      .status();
}

TEST(MotionClipTest, HasDurationPeriodAndTracks) {
  const auto clip =
      MotionClip::Create(Body(), {Hinge({0, 0.5, 2})},
                         {.name = "wave", .frame_time_s = 0.5, .seam_s = 0.25});
  ASSERT_TRUE(clip.ok()) << clip.status();
  EXPECT_EQ(clip->name(), "wave");
  EXPECT_EQ(clip->duration_s(), 2);
  EXPECT_EQ(clip->period_s(), 2.25);
  EXPECT_EQ(clip->track_count(), 1);
  EXPECT_EQ(clip->FindTrack(2, PosePartKind::kNumbers), 0);
  EXPECT_EQ(clip->FindTrack(1, PosePartKind::kRotation), -1);
  EXPECT_GT(clip->ByteSize(), 6 * sizeof(double));
}

TEST(MotionClipTest, WithoutTracksItStands) {
  const auto clip = MotionClip::Create(Body(), {});
  ASSERT_TRUE(clip.ok());
  EXPECT_EQ(clip->duration_s(), 0);
  EXPECT_EQ(clip->properties().base_positions, Body()->rest_positions());
}

TEST(MotionClipTest, PartsOfAPoseAreItsNumbersAndRotations) {
  const std::vector<PosePart> parts = PosePartsOf(*Body());
  ASSERT_EQ(parts.size(), 4);
  EXPECT_EQ(parts[0].position_count, 3);
  EXPECT_EQ(parts[1].position_offset, 3);
  EXPECT_EQ(parts[1].velocity_offset, 3);
  EXPECT_EQ(parts[2].position_offset, 7);
  EXPECT_EQ(parts[2].velocity_offset, 6);
  EXPECT_EQ(parts[3].position_offset, 11);
  EXPECT_EQ(parts[3].velocity_count, 1);
}

TEST(MotionClipTest, RefusesTimesThatDoNotGrow) {
  EXPECT_THAT(CreateWith(Hinge({})), Fails(kBad, "tracks[0].times_s"));
  EXPECT_THAT(CreateWith(Hinge({0, 1, 1})),
              Fails(kBad, "times_s[2]: want more"));
  EXPECT_THAT(CreateWith(Hinge({-1})), Fails(kBad, "got -1"));
  EXPECT_THAT(CreateWith(Hinge({0, std::nan("")})), Fails(kBad, "got nan"));
  EXPECT_TRUE(CreateWith(Hinge({0, 1, std::nextafter(1, 2)})).ok());
}

TEST(MotionClipTest, RefusesValuesThatDoNotFit) {
  JointTrack short_one = Hinge({0, 1});
  short_one.values.resize(1, 1);
  EXPECT_THAT(CreateWith(short_one),
              Fails(kBad, "values: want 2 keys of 1 numbers, got 1 of 1"));
  JointTrack infinite = Hinge({0, 1});
  infinite.values(0, 1) = INFINITY;
  EXPECT_THAT(CreateWith(infinite), Fails(kBad, "values[1][0]"));
  JointTrack ball{.joint = 1, .times_s = {0}};
  ball.values = Eigen::Vector4d(0, 0, 0, 1.01);
  EXPECT_THAT(CreateWith(ball), Fails(kBad, "values[0]: want a unit"));
  ball.values = Eigen::Vector4d(0, 0, 0, 1.0005);
  EXPECT_TRUE(CreateWith(ball).ok());
}

TEST(MotionClipTest, RefusesTangentsWithoutCubicAndCubicWithout) {
  JointTrack track = Hinge({0, 1});
  track.in_tangents = track.values;
  EXPECT_THAT(CreateWith(track), Fails(kBad, "in_tangents"));
  track.interpolation = Interpolation::kCubicSpline;
  EXPECT_THAT(CreateWith(track), Fails(kBad, "out_tangents"));
  track.out_tangents = track.values;
  EXPECT_TRUE(CreateWith(track).ok());
}

TEST(MotionClipTest, RefusesJointsWithoutSuchNumbers) {
  JointTrack track = Hinge({0});
  track.joint = 3;
  EXPECT_THAT(CreateWith(track), Fails(kBad, "\"twin\", a mimic, has no"));
  track.joint = 1;
  EXPECT_THAT(CreateWith(track), Fails(kBad, "spherical, has no numbers"));
  track.joint = 4;
  EXPECT_THAT(CreateWith(track), Fails(kBad, "want a joint, 0 to 3, got 4"));
  EXPECT_THAT(MotionClip::Create(Body(), {Hinge({0}), Hinge({1})}).status(),
              Fails(kBad, "tracks[1].joint: the numbers of joint \"hinge\""));
}

TEST(MotionClipTest, RefusesPropertiesAndListsAllFaults) {
  JointTrack track = Hinge({0});
  track.joint = -1;
  const absl::Status status =
      CreateWith(track, {.frame_time_s = -0.5,
                         .seam_s = INFINITY,
                         .base_positions = Eigen::VectorXd::Zero(2)});
  for (const char* words : {"frame_time_s: want a finite number >= 0, got -0.5",
                            "seam_s", "base_positions", "tracks[0].joint"}) {
    EXPECT_THAT(status, Fails(kBad, words));
  }
}

TEST(MotionClipTest, RotationsRunOnInOneHemisphere) {
  JointTrack ball{.joint = 1, .times_s = {0, 1, 2}};
  ball.values.resize(4, 3);
  ball.values << 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, -1, 1;
  const auto clip = MotionClip::Create(Body(), {ball});
  ASSERT_TRUE(clip.ok());
  EXPECT_EQ(clip->track(0).values(3, 1), 1);
  ball.interpolation = Interpolation::kCubicSpline;
  ball.in_tangents = ball.out_tangents = Eigen::MatrixXd::Zero(4, 3);
  const auto spline = MotionClip::Create(Body(), {ball});
  ASSERT_TRUE(spline.ok());
  EXPECT_EQ(spline->track(0).values(3, 1), -1);
}

}  // namespace
}  // namespace gelenk
