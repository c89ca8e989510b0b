#include "convert/motion_quality.h"

#include <gtest/gtest.h>

namespace gelenk::convert {
namespace {

TEST(MotionQualityTest, ComesRoundWhole) {
  MotionQuality quality;
  quality.skate = {.label_cm_s = 1,
                   .label_with_turning_cm_s = 2,
                   .weighted_cm_s = 3,
                   .rule_cm_s = 4,
                   .m_per_contact_s = 5,
                   .contact_ratio = 0.6};
  quality.penetration = {.max_m = 7, .mean_m = 8};
  quality.hyper_extended_frames = 9;
  quality.jerk_m_s3 = 10;
  quality.largest_turn_deg = 90;
  v1::MotionQuality proto;
  ToProto(quality, &proto);
  // Nothing is left out on the way.
  for (int i = 0; i < proto.GetDescriptor()->field_count(); ++i) {
    const auto* field = proto.GetDescriptor()->field(i);
    EXPECT_TRUE(proto.GetReflection()->HasField(proto, field)) << field->name();
  }
  v1::MotionQuality again;
  ToProto(FromProto(proto), &again);
  EXPECT_EQ(again.SerializeAsString(), proto.SerializeAsString());
  EXPECT_DOUBLE_EQ(FromProto(proto).largest_turn_deg, 90);
}

TEST(MotionComparisonTest, ComesRoundWhole) {
  MotionComparison comparison;
  comparison.label_skate_ratio = 0.1;
  comparison.rule_skate_ratio = 0.2;
  comparison.jerk_ratio = 0.3;
  comparison.new_hyper_extended_frames = 4;
  comparison.largest_extra_turn_deg = 45;
  v1::MotionComparison proto;
  ToProto(comparison, &proto);
  for (int i = 0; i < proto.GetDescriptor()->field_count(); ++i) {
    const auto* field = proto.GetDescriptor()->field(i);
    EXPECT_TRUE(proto.GetReflection()->HasField(proto, field)) << field->name();
  }
  v1::MotionComparison again;
  ToProto(FromProto(proto), &again);
  EXPECT_EQ(again.SerializeAsString(), proto.SerializeAsString());
}

}  // namespace
}  // namespace gelenk::convert
