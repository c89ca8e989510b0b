#include "convert/joint_track.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gelenk/motion/clip_frames.h"
#include "tests/testing/example_bodies.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/violation_lines.h"

namespace gelenk::convert {
namespace {

using ::gelenk::testing::PersonWithFingers;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kFrameTime_s = 0.0083333;

class ConvertJointTrackTest : public ::testing::Test {
 protected:
  MotionClip Frames(int count, Interpolation interpolation) const {
    Random random(4);
    Eigen::MatrixXd frames(body_->position_count(), count);
    for (int i = 0; i < count; ++i) frames.col(i) = RandomPose(random, *body_);
    return ClipFromFrames(body_, frames, {.frame_time_s = kFrameTime_s},
                          interpolation)
        .value();
  }

  // The id of a joint that is free, or spherical.
  std::string JointOf(JointType type) const {
    for (int i = 0; i < body_->joint_count(); ++i) {
      if (body_->joint(i).type == type) return body_->joint(i).id;
    }
    return "";
  }

  const std::shared_ptr<const Skeleton> body_ = PersonWithFingers();
};

TEST_F(ConvertJointTrackTest, TracksComeRoundBitByBit) {
  for (Interpolation interpolation :
       {Interpolation::kStep, Interpolation::kLinear,
        Interpolation::kCatmullRom}) {
    const MotionClip clip = Frames(7, interpolation);
    for (double frame_time_s : {kFrameTime_s, 0.0}) {
      for (int i = 0; i < clip.track_count(); ++i) {
        const JointTrack& track = clip.track(i);
        v1::JointTrack proto;
        ToProto(*body_, frame_time_s, track, 0, 7, &proto);
        EXPECT_EQ(proto.times_s_size(), frame_time_s > 0 ? 0 : 7);
        v1::JointTrack sent;
        ASSERT_TRUE(sent.ParseFromString(proto.SerializeAsString()));
        const auto again = FromProto(*body_, frame_time_s, sent);
        ASSERT_TRUE(again.ok()) << again.status();
        EXPECT_EQ(again->joint, track.joint);
        EXPECT_EQ(again->kind, track.kind);
        EXPECT_EQ(again->interpolation, track.interpolation);
        EXPECT_EQ(again->times_s, track.times_s);
        EXPECT_EQ(again->values, track.values);
      }
    }
  }
}

TEST_F(ConvertJointTrackTest, TangentsComeRound) {
  JointTrack track = Frames(3, Interpolation::kLinear).track(1);
  track.interpolation = Interpolation::kCubicSpline;
  track.in_tangents = Eigen::MatrixXd::Random(track.values.rows(), 3);
  track.out_tangents = Eigen::MatrixXd::Random(track.values.rows(), 3);
  v1::JointTrack proto;
  ToProto(*body_, 0, track, 0, 3, &proto);
  const auto again = FromProto(*body_, 0, proto);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->in_tangents, track.in_tangents);
  EXPECT_EQ(again->out_tangents, track.out_tangents);
}

TEST_F(ConvertJointTrackTest, PiecesHoldTheirKeysOnly) {
  const MotionClip clip = Frames(7, Interpolation::kLinear);
  const JointTrack& track = clip.track(0);
  v1::JointTrack proto;
  ToProto(*body_, 0, track, 2, 3, &proto);
  EXPECT_THAT(proto.times_s(), ElementsAre(track.times_s[2], track.times_s[3],
                                           track.times_s[4]));
  EXPECT_EQ(proto.values_size(), 3 * track.values.rows());
  EXPECT_EQ(proto.values(0), track.values(0, 2));
}

TEST_F(ConvertJointTrackTest, APartThatIsTheOnlyOneNeedsNoName) {
  const auto part = FromProto(*body_, JointOf(JointType::kSpherical),
                              v1::JOINT_PART_UNSPECIFIED);
  ASSERT_TRUE(part.ok()) << part.status();
  EXPECT_EQ(part->kind, PosePartKind::kRotation);
  EXPECT_THAT(ViolationLines(FromProto(*body_, JointOf(JointType::kFree),
                                       v1::JOINT_PART_UNSPECIFIED)
                                 .status()),
              ElementsAre(HasSubstr("numbers and a rotation")));
  EXPECT_THAT(ViolationLines(FromProto(*body_, JointOf(JointType::kSpherical),
                                       v1::JOINT_PART_NUMBERS)
                                 .status()),
              ElementsAre(HasSubstr("a rotation only")));
}

TEST_F(ConvertJointTrackTest, NamesEveryBadTrack) {
  google::protobuf::RepeatedPtrField<v1::JointTrack> tracks;
  tracks.Add()->set_joint_id("tail");
  v1::JointTrack& odd = *tracks.Add();
  odd.set_joint_id(JointOf(JointType::kSpherical));
  odd.add_times_s(0);
  odd.add_values(0);
  odd.set_interpolation(static_cast<v1::Interpolation>(9));
  v1::JointTrack& bare = *tracks.Add();
  bare.set_joint_id(JointOf(JointType::kSpherical));
  v1::JointTrack& straight = *tracks.Add();
  straight.set_joint_id(JointOf(JointType::kSpherical));
  straight.set_interpolation(v1::INTERPOLATION_CUBIC_SPLINE);
  straight.add_times_s(0);
  for (double number : {0, 0, 0, 1}) straight.add_values(number);
  EXPECT_THAT(
      ViolationLines(FromProto(*body_, 0, tracks).status()),
      ElementsAre(HasSubstr("tracks[0].joint_id: no joint"),
                  "tracks[1].interpolation: no such interpolation: 9",
                  "tracks[1].values: want 4 for each of 1 keys, got 1",
                  "tracks[2].times_s: want at least one, got none",
                  "tracks[3].in_tangents: want 4 for each of 1 keys, got 0",
                  "tracks[3].out_tangents: want 4 for each of 1 keys, got 0"));
}

}  // namespace
}  // namespace gelenk::convert
