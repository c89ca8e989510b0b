#include "gelenk/contact/foot_skate.h"

#include <gtest/gtest.h>

#include "tests/core/contact/stepping_feet.h"

namespace gelenk {
namespace {

constexpr double kFrameTime = 0.01;
constexpr double kExact = 1e-9;

// A left foot that slides at `speed`, `height` above the ground, beside a right
// one that flies.
std::vector<FootPoints> Sliding(double speed, double height, int count) {
  std::vector<FootPoints> frames;
  for (int f = 0; f < count; ++f) {
    frames.push_back({FlatFoot({0, height, speed * f * kFrameTime}),
                      FlatFoot({1, 1, f * kFrameTime})});
  }
  return frames;
}

ContactLabels LeftOnly(int count, Contact contact) {
  ContactLabels labels;
  labels.frames.resize(count);
  for (FootContacts& frame : labels.frames) frame[0].fill(contact);
  return labels;
}

TEST(FootSkateTest, ASlideIsMeasuredByEveryDefinition) {
  const std::vector<FootPoints> frames = Sliding(0.2, 0, 101);
  const FootSkate skate =
      MeasureSkate({frames, kFrameTime, {}}, LeftOnly(101, Contact::kPlanted));
  EXPECT_NEAR(skate.label_cm_s, 20, kExact);
  EXPECT_NEAR(skate.label_with_turning_cm_s, 20, kExact);
  EXPECT_NEAR(skate.rule_cm_s, 20, kExact);
  EXPECT_NEAR(skate.weighted_cm_s, 20, kExact);  // 2 - 2^0
  EXPECT_NEAR(skate.m_per_contact_s, 0.2, kExact);
  EXPECT_NEAR(skate.contact_ratio, 0.5, kExact);
}

TEST(FootSkateTest, TheWeightFallsToNothingWithHeight) {
  const double half = kWeightedSkateHeight / 2;
  const FootSkate skate =
      MeasureSkate({Sliding(0.2, half, 11), kFrameTime, {}}, LeftOnly(11, {}));
  EXPECT_NEAR(skate.weighted_cm_s, 20 * (2 - std::sqrt(2)), kExact);
  const FootSkate above = MeasureSkate(
      {Sliding(0.2, kWeightedSkateHeight + 1e-6, 11), kFrameTime, {}},
      LeftOnly(11, {}));
  EXPECT_EQ(above.weighted_cm_s, 0);
  EXPECT_EQ(above.label_cm_s, 0);
}

TEST(FootSkateTest, WhatTurnsDoesNotSkate) {
  ContactLabels labels = LeftOnly(11, Contact::kTurning);
  const FootSkate skate =
      MeasureSkate({Sliding(0.2, 0, 11), kFrameTime, {}}, labels);
  EXPECT_EQ(skate.label_cm_s, 0);
  EXPECT_NEAR(skate.label_with_turning_cm_s, 20, kExact);
}

TEST(FootSkateTest, LandingAndLiftingOffDoNotCountAsPlanted) {
  // Planted in one frame alone: no pair of frames.
  ContactLabels labels = LeftOnly(11, Contact::kNone);
  labels.frames[5][0].fill(Contact::kPlanted);
  const FootSkate skate =
      MeasureSkate({Sliding(0.2, 0, 11), kFrameTime, {}}, labels);
  EXPECT_EQ(skate.label_cm_s, 0);
}

TEST(PenetrationTest, DepthBelowThePlantedHeight) {
  FeetGeometry feet;
  feet.planted_heights[0] = {0, 0.02, 0};
  // Of six points heel and tip are 1 cm deep, the ball 3 cm.
  const Penetration sunk =
      MeasurePenetration({Sliding(0, -0.01, 5), kFrameTime, feet});
  EXPECT_NEAR(sunk.max_m, 0.03, kExact);
  EXPECT_NEAR(sunk.mean_m, 0.05 / 6, kExact);
  EXPECT_EQ(MeasurePenetration({Sliding(0, 0.02, 5), kFrameTime, feet}).max_m,
            0);
}

}  // namespace
}  // namespace gelenk
