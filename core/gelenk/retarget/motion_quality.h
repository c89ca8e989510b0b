// What is measured of a motion, and of one made from another. Definitions, with
// the reasons: docs/motion-quality.md.
#ifndef GELENK_RETARGET_MOTION_QUALITY_H_
#define GELENK_RETARGET_MOTION_QUALITY_H_

#include <array>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/contact/foot_skate.h"
#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/body_pose.h"

namespace gelenk {

// A clip as a body in motion. Must outlive its use.
struct BodyMotionView {
  const BodyModel& model;
  absl::Span<const BodyPose> frames;
  double frame_time_s = 1.0 / 30;
};

// What jerk is measured at.
inline constexpr std::array<BodyRole, 6> kJerkRoles = {
    BodyRole::kLeftHand,  BodyRole::kRightHand, BodyRole::kLeftFoot,
    BodyRole::kRightFoot, BodyRole::kHead,      BodyRole::kPelvis};

struct MotionQuality {
  FootSkate skate;
  Penetration penetration;
  // Frames of legs that are overstretched or bent backwards.
  int hyper_extended_frames = 0;
  // Mean third difference of hands, feet, head and pelvis, m/s^3.
  double jerk_m_s3 = 0;
  // The same of each, in the order of kJerkRoles; 0 where it is missing.
  std::array<double, 6> part_jerk_m_s3 = {};
  // The largest turn of a part of the body from one frame to the next, degrees.
  double largest_turn_deg = 0;
};

// What a motion is beside the one that it was made from.
struct MotionComparison {
  // Skate relative to the source's, each by its own leg; 0 where the source
  // stands perfectly still and so does the other.
  double label_skate_ratio = 0;
  double rule_skate_ratio = 0;
  // Of hands, feet, head and pelvis together; the source's made larger as the
  // legs or the bones from the pelvis to the part are longer, whichever is
  // more.
  double jerk_ratio = 0;
  // Frames of legs that are hyper-extended where the source's are not.
  int new_hyper_extended_frames = 0;
  // The most that a part turns in a frame beyond what it does in the source,
  // degrees.
  double largest_extra_turn_deg = 0;
};

FeetGeometry FeetOf(const BodyModel& model);
std::vector<FootPoints> FootPointsOf(absl::Span<const BodyPose> frames);

// By `labels`, the clip's own unless it was made from another. `floor` is the
// ground under the body; null means that of the labels.
MotionQuality MeasureMotion(const BodyMotionView& motion,
                            const ContactLabels& labels,
                            const Ground* floor = nullptr);

// Both have as many frames.
MotionComparison CompareMotion(const BodyMotionView& source,
                               const MotionQuality& source_quality,
                               const BodyMotionView& made,
                               const MotionQuality& made_quality);

}  // namespace gelenk

#endif  // GELENK_RETARGET_MOTION_QUALITY_H_
