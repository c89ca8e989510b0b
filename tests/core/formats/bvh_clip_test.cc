#include "gelenk/formats/bvh_clip.h"

#include <gtest/gtest.h>

#include "gelenk/formats/bvh_motion.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/formats/bvh_writer.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"
#include "tests/testing/status_matchers.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Fails;
using ::gelenk::testing::WalkingBvh;

TEST(BvhClipTest, GoesInAndOutNumberForNumber) {
  const BvhDocument document = ReadBvh(WalkingBvh(40)).value();
  const BvhImport import = ImportBvh(document).value();
  const absl::StatusOr<MotionClip> clip = ClipFromBvh(document, import, "walk");
  ASSERT_TRUE(clip.ok()) << clip.status();
  EXPECT_EQ(clip->name(), "walk");
  EXPECT_EQ(clip->properties().frame_time_s, document.frame_time_s);
  const absl::StatusOr<BvhDocument> back = BvhFromClip(document, import, *clip);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->frame_time_text, document.frame_time_text);
  ASSERT_EQ(back->motion.cols(), 40);
  // Degrees and centimetres, through quaternions and metres.
  EXPECT_LT((back->motion - document.motion).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_TRUE(ReadBvh(WriteBvh(*back)).ok());
}

TEST(BvhClipTest, AClipOfAnotherRateIsWrittenAtItsOwn) {
  const BvhDocument document = ReadBvh(WalkingBvh(41)).value();
  const BvhImport import = ImportBvh(document).value();
  const MotionClip clip = ClipFromBvh(document, import).value();
  const double half_s = 2 * document.frame_time_s;
  const MotionClip slow =
      ClipFromFrames(import.skeleton, FramesFromClip(clip, half_s).value(),
                     {.frame_time_s = half_s})
          .value();
  const BvhDocument back = BvhFromClip(document, import, slow).value();
  EXPECT_EQ(back.frame_count(), 21);
  EXPECT_EQ(back.frame_time_s, half_s);
  EXPECT_EQ(ReadBvh(WriteBvh(back))->frame_time_s, half_s);
}

TEST(BvhClipTest, RefusesAFileWithoutFramesOrTime) {
  BvhDocument document = ReadBvh(WalkingBvh(3)).value();
  const BvhImport import = ImportBvh(document).value();
  document.frame_time_s = 0;
  EXPECT_THAT(ClipFromBvh(document, import).status(),
              Fails(absl::StatusCode::kInvalidArgument, "frame_time_s"));
  document.frame_time_s = 0.1;
  document.motion.resize(document.motion.rows(), 0);
  EXPECT_THAT(ClipFromBvh(document, import).status(),
              Fails(absl::StatusCode::kInvalidArgument, "frames"));
}

// Skeletons of all sorts of joints, none of which came from a file.
TEST(BvhClipTest, AnyClipBecomesAFileThatMovesTheSame) {
  testing::Random random(1);
  for (int trial = 0; trial < 10; ++trial) {
    const auto skeleton = testing::RandomSkeleton(random);
    Eigen::MatrixXd frames(skeleton->position_count(), 8);
    for (int i = 0; i < 8; ++i) {
      frames.col(i) = testing::RandomPose(random, *skeleton);
    }
    const MotionClip clip =
        ClipFromFrames(skeleton, frames, {.frame_time_s = 0.04}).value();
    const absl::StatusOr<BvhDocument> written = BvhFromClip(clip, 0.01);
    ASSERT_TRUE(written.ok()) << written.status();
    const absl::StatusOr<BvhDocument> read = ReadBvh(WriteBvh(*written));
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_EQ(read->frame_time_s, 0.04);
    const BvhImport import = ImportBvh(*read, {.unit_m = 0.01}).value();
    const Eigen::MatrixXd poses = PosesFromBvh(*read, import).value();
    ASSERT_EQ(poses.cols(), 8);
    WorldTransforms expected, actual;
    for (int i = 0; i < 8; ++i) {
      ForwardKinematics(*skeleton, frames.col(i), expected);
      ForwardKinematics(*import.skeleton, poses.col(i), actual);
      for (int joint = 0; joint < skeleton->joint_count(); ++joint) {
        const int there = import.skeleton->FindJoint(skeleton->joint(joint).id);
        ASSERT_GE(there, 0);
        EXPECT_LT(
            (expected[joint].translation - actual[there].translation).norm(),
            1e-11);
        EXPECT_LT(
            AngleBetween(expected[joint].rotation, actual[there].rotation),
            1e-11);
      }
    }
  }
}

TEST(BvhClipTest, WritesNamesWithoutBracesAndRefusesUnits) {
  Joint joint;
  joint.id = "a{b}";
  const auto skeleton = SkeletonBuilder().AddJoint(joint).Build().value();
  const MotionClip clip = MotionClip::Create(skeleton, {}).value();
  EXPECT_EQ(BvhFromClip(clip)->joints[0].name, "a_b_");
  EXPECT_THAT(BvhFromClip(clip, 0).status(),
              Fails(absl::StatusCode::kInvalidArgument, "unit_m"));
}

}  // namespace
}  // namespace gelenk
