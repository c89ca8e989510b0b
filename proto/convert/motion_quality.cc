#include "convert/motion_quality.h"

#include <numbers>

namespace gelenk::convert {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180;

}  // namespace

void ToProto(const MotionQuality& quality, v1::MotionQuality* proto) {
  const FootSkate& skate = quality.skate;
  proto->set_label_skate_cm_s(skate.label_cm_s);
  proto->set_label_skate_with_turning_cm_s(skate.label_with_turning_cm_s);
  proto->set_weighted_skate_cm_s(skate.weighted_cm_s);
  proto->set_rule_skate_cm_s(skate.rule_cm_s);
  proto->set_slide_m_per_contact_s(skate.m_per_contact_s);
  proto->set_contact_ratio(skate.contact_ratio);
  proto->set_max_penetration_m(quality.penetration.max_m);
  proto->set_mean_penetration_m(quality.penetration.mean_m);
  proto->set_hyper_extended_frame_count(quality.hyper_extended_frames);
  proto->set_jerk_m_s3(quality.jerk_m_s3);
  proto->set_largest_turn_rad(quality.largest_turn_deg * kRadPerDegree);
}

void ToProto(const MotionComparison& comparison, v1::MotionComparison* proto) {
  proto->set_label_skate_ratio(comparison.label_skate_ratio);
  proto->set_rule_skate_ratio(comparison.rule_skate_ratio);
  proto->set_jerk_ratio(comparison.jerk_ratio);
  proto->set_new_hyper_extended_frame_count(
      comparison.new_hyper_extended_frames);
  proto->set_largest_extra_turn_rad(comparison.largest_extra_turn_deg *
                                    kRadPerDegree);
}

MotionQuality FromProto(const v1::MotionQuality& proto) {
  MotionQuality quality;
  quality.skate.label_cm_s = proto.label_skate_cm_s();
  quality.skate.label_with_turning_cm_s = proto.label_skate_with_turning_cm_s();
  quality.skate.weighted_cm_s = proto.weighted_skate_cm_s();
  quality.skate.rule_cm_s = proto.rule_skate_cm_s();
  quality.skate.m_per_contact_s = proto.slide_m_per_contact_s();
  quality.skate.contact_ratio = proto.contact_ratio();
  quality.penetration.max_m = proto.max_penetration_m();
  quality.penetration.mean_m = proto.mean_penetration_m();
  quality.hyper_extended_frames = proto.hyper_extended_frame_count();
  quality.jerk_m_s3 = proto.jerk_m_s3();
  quality.largest_turn_deg = proto.largest_turn_rad() / kRadPerDegree;
  return quality;
}

MotionComparison FromProto(const v1::MotionComparison& proto) {
  MotionComparison comparison;
  comparison.label_skate_ratio = proto.label_skate_ratio();
  comparison.rule_skate_ratio = proto.rule_skate_ratio();
  comparison.jerk_ratio = proto.jerk_ratio();
  comparison.new_hyper_extended_frames = proto.new_hyper_extended_frame_count();
  comparison.largest_extra_turn_deg =
      proto.largest_extra_turn_rad() / kRadPerDegree;
  return comparison;
}

}  // namespace gelenk::convert
