#include "gelenk/retarget/plant_feet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "gelenk/formats/bvh_clip.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/retarget/humanoid.h"
#include "gelenk/retarget/moving_body.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/status_matchers.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {
namespace {

using testing::Fails;
using ::testing::HasSubstr;

MotionClip Walk() {
  const BvhDocument document = ReadBvh(testing::WalkingBvh(120)).value();
  return ClipFromBvh(document, ImportBvh(document).value()).value();
}

MovingBody BodyOf(const MotionClip& clip) {
  return MakeMovingBody(clip.skeleton(), FramesFromClip(clip).value(),
                        FrameTimeOf(clip))
      .value();
}

// Somebody who stands and slides sideways and sinks a little, as on ice that
// gives way.
MotionClip Slide() {
  const auto body = MakeHumanoid();
  constexpr int kFrames = 60;
  constexpr double kFrameTime_s = 1.0 / 30;
  Eigen::MatrixXd frames = body->rest_positions().replicate(1, kFrames);
  for (int i = 0; i < kFrames; ++i) {
    frames(0, i) += 0.04 * i * kFrameTime_s;
    frames(1, i) -= 0.005 * std::sin(0.3 * i);
  }
  return ClipFromFrames(body, frames, {.frame_time_s = kFrameTime_s}).value();
}

TEST(PlantFeetTest, FeetNeitherSlideNorSink) {
  const MotionClip slide = Slide();
  const auto planted = PlantFeet(slide);
  ASSERT_TRUE(planted.ok()) << planted.status();
  const MovingBody before = BodyOf(slide);
  const auto measured = MeasureBody(BodyOf(planted->clip), &before);
  ASSERT_TRUE(measured.ok()) << measured.status();
  EXPECT_NEAR(measured->source->skate.label_cm_s, 4, 0.5);
  EXPECT_LE(measured->quality.skate.label_cm_s, 0.2);
  EXPECT_GT(measured->quality.skate.contact_ratio, 0.9);
  EXPECT_LE(measured->quality.penetration.max_m, 1e-3);
  EXPECT_EQ(measured->comparison->new_hyper_extended_frames, 0);
}

TEST(PlantFeetTest, AllElseStaysAsItIs) {
  const MotionClip walk = Walk();
  const auto planted = PlantFeet(walk);
  ASSERT_TRUE(planted.ok()) << planted.status();
  const Eigen::MatrixXd before = FramesFromClip(walk).value();
  const Eigen::MatrixXd after = FramesFromClip(planted->clip).value();
  ASSERT_EQ(after.cols(), before.cols());
  for (const char* id : {"Spine", "Head", "LeftArm", "RightHand"}) {
    const int joint = walk.skeleton()->FindJoint(id);
    ASSERT_GE(joint, 0) << id;
    const int at = walk.skeleton()->span(joint).quaternion_offset;
    EXPECT_EQ(after.middleRows(at, 4), before.middleRows(at, 4)) << id;
  }
}

TEST(PlantFeetTest, WithoutLegsThereIsNothingToPlant) {
  const auto clip = MotionClip::Create(testing::PandaArm(), {}).value();
  EXPECT_FALSE(PlantFeet(clip).ok());
}

TEST(MovingBodyTest, OtherFrameCountsAreNotCompared) {
  const MovingBody walk = BodyOf(Walk());
  MovingBody shorter = walk;
  shorter.positions = Eigen::MatrixXd(walk.positions.leftCols(9));
  EXPECT_THAT(MeasureBody(shorter, &walk).status(),
              Fails(absl::StatusCode::kInvalidArgument, "9 frames of 0.02 s"));
  shorter.positions.resize(walk.positions.rows(), 0);
  EXPECT_THAT(MeasureBody(shorter, nullptr).status(),
              Fails(absl::StatusCode::kInvalidArgument, "no motion"));
}

// The walk behind two frames that are none of it, as a conversion leaves them
// that has smoothed the jump out of a rest pose.
Eigen::MatrixXd FramesBehindARestPose(const MotionClip& clip) {
  const Eigen::MatrixXd walk = FramesFromClip(clip).value();
  Eigen::MatrixXd frames(walk.rows(), walk.cols() + 2);
  frames.rightCols(walk.cols()) = walk;
  // An arm that hangs in the walk, raised to the side and on its way down.
  const int arm = clip.skeleton()->FindJoint("LeftArm");
  const int offset = clip.skeleton()->span(arm).quaternion_offset;
  const Eigen::VectorXd first = walk.col(0);
  const Eigen::Quaterniond hanging(first.segment<4>(offset));
  for (int f : {0, 1}) {
    const Eigen::AngleAxisd raised((2 - f) * std::numbers::pi / 4,
                                   Eigen::Vector3d::UnitZ());
    frames.col(f) = walk.col(0);
    frames.col(f).segment<4>(offset) = (hanging * raised).coeffs();
  }
  return frames;
}

TEST(MovingBodyTest, FramesBeforeTheMotionArePairedAsAFilterLeavesThemOut) {
  const MotionClip walk = Walk();
  MovingBody raw = MakeMovingBody(walk.skeleton(), FramesBehindARestPose(walk),
                                  FrameTimeOf(walk))
                       .value();
  EXPECT_EQ(raw.left_out, 1);
  EXPECT_EQ(raw.way_frames, 1);
  // As a filter writes it: the walk alone.
  MovingBody filtered = BodyOf(walk);
  ASSERT_FALSE(MeasureBody(filtered, &raw).ok());
  for (bool filtered_first : {true, false}) {
    MovingBody longer = raw;
    MovingBody shorter = filtered;
    if (filtered_first) {
      PairFrames(shorter, longer);
    } else {
      PairFrames(longer, shorter);
    }
    EXPECT_EQ(longer.positions, shorter.positions);
    EXPECT_THAT(longer.notes.back(), HasSubstr("1 frame at the start"));
    EXPECT_TRUE(MeasureBody(shorter, &longer).ok());
  }
}

TEST(MovingBodyTest, OtherDifferencesAreNotPaired) {
  MovingBody walk = BodyOf(Walk());
  MovingBody shorter = walk;
  shorter.positions = Eigen::MatrixXd(walk.positions.leftCols(119));
  PairFrames(shorter, walk);
  EXPECT_EQ(walk.positions.cols(), 120);
  EXPECT_FALSE(MeasureBody(shorter, &walk).ok());
}

TEST(MovingBodyTest, AWalkOntoItselfStaysAWalk) {
  const MovingBody walk = BodyOf(Walk());
  for (LookAhead look_ahead : {LookAhead::kNone, LookAhead::kWholeClip}) {
    const auto positions = RetargetBody(walk, walk.model, look_ahead, {});
    ASSERT_TRUE(positions.ok()) << positions.status();
    EXPECT_EQ(positions->cols(), walk.positions.cols());
    EXPECT_EQ(positions->rows(), walk.positions.rows());
  }
}

}  // namespace
}  // namespace gelenk
