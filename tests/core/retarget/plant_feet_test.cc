#include "gelenk/retarget/plant_feet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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
