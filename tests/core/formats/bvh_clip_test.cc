#include "gelenk/formats/bvh_clip.h"

#include <gtest/gtest.h>

#include "gelenk/formats/bvh_reader.h"
#include "gelenk/formats/bvh_writer.h"
#include "gelenk/motion/clip_frames.h"
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

}  // namespace
}  // namespace gelenk
