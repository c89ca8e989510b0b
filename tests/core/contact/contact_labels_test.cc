#include "gelenk/contact/contact_labels.h"

#include <gtest/gtest.h>

#include "tests/core/contact/stepping_feet.h"

namespace gelenk {
namespace {

constexpr double kFrameTime = 0.01;

TEST(ContactLabelsTest, AStepIsTheOnlyTimeWithoutContact) {
  const ContactLabels labels =
      LabelContacts(OneStep(kFrameTime), kFrameTime, {});
  // 0.5 s of 2.5 s on one foot of two; a little less, because a step begins and
  // ends slowly.
  EXPECT_NEAR(labels.ContactRatio(), 0.9, 0.02);
  EXPECT_NEAR(labels.floor_m, 0, 1e-3);
  EXPECT_EQ(labels.frames[125][0][kHeel], Contact::kNone);
  for (const FootContacts& frame : labels.frames) {
    EXPECT_EQ(frame[1][kBall], Contact::kPlanted);
  }
}

TEST(ContactLabelsTest, GapsAreFilledAndFlickersDropped) {
  // A standing foot jumps up for 30 ms, a flying one touches for 30 ms.
  std::vector<FootPoints> frames(100);
  for (int f = 0; f < 100; ++f) {
    const bool middle = f >= 50 && f < 53;
    frames[f] = {FlatFoot({0, middle ? 0.06 : 0, 0}),
                 FlatFoot({1, middle ? 0.0 : 0.2, 0})};
  }
  const FlatGround ground;
  const ContactLabels labels = LabelContacts(frames, kFrameTime, {}, &ground);
  for (const FootContacts& frame : labels.frames) {
    EXPECT_EQ(frame[0][kHeel], Contact::kPlanted);
    EXPECT_EQ(frame[1][kHeel], Contact::kNone);
  }
}

TEST(ContactLabelsTest, ThreeFramesTellNothing) {
  const std::vector<FootPoints> frames(3, OneStep(kFrameTime)[0]);
  EXPECT_EQ(LabelContacts(frames, kFrameTime, {}).ContactRatio(), 0);
}

TEST(ContactLabelsTest, APointThatIsAlwaysALittleHighHasItsOwnBias) {
  std::vector<FootPoints> frames = OneStep(kFrameTime);
  for (FootPoints& frame : frames) frame[0][kBall].y() += 0.035;
  const ContactLabels labels = LabelContacts(frames, kFrameTime, {});
  EXPECT_NEAR(labels.bias_m[0][kBall], 0.035, 2e-3);
  EXPECT_EQ(labels.frames[50][0][kBall], Contact::kPlanted);
}

}  // namespace
}  // namespace gelenk
