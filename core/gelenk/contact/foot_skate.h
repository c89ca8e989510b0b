// How much planted feet slide and how deep they sink. Definitions, with the
// reasons: docs/motion-quality.md.
#ifndef GELENK_CONTACT_FOOT_SKATE_H_
#define GELENK_CONTACT_FOOT_SKATE_H_

#include "absl/types/span.h"
#include "gelenk/contact/contact_labels.h"

namespace gelenk {

// The height at which a sliding point does not count any more, m, for a leg of
// kReferenceLegM.
inline constexpr double kWeightedSkateHeight = 0.033;
// Without labels a point counts as planted below this height and speed.
inline constexpr double kRuleMaxHeight = 0.03;
inline constexpr double kRuleMaxSpeed = 0.5;

// The feet of a clip above their floor. Must outlive its use.
struct FeetView {
  absl::Span<const FootPoints> frames;
  double frame_time_s = 1.0 / 30;
  FeetGeometry feet;
  // The height of the floor under each planted point; one number for all where
  // it is known.
  PerFootPoint<double> floor_m = {};
  // Replaces floor_m where it is set.
  const Ground* ground = nullptr;
};

struct FootSkate {
  // Mean horizontal speed of planted heels and balls, cm/s; those about which a
  // foot turns count, those that turn do not.
  double label_cm_s = 0;
  // The same, with those that turn.
  double label_with_turning_cm_s = 0;
  // Mean of v * (2 - 2^(h/H)) over heels and balls lower than H.
  double weighted_cm_s = 0;
  // Mean horizontal speed of heels and balls that are low and slow, whatever
  // the labels say.
  double rule_cm_s = 0;
  // Path that planted points slide, over the time that feet stand.
  double m_per_contact_s = 0;
  double contact_ratio = 0;
};

struct Penetration {
  // Depth of heels, balls and tips below their planted height, m.
  double max_m = 0;
  double mean_m = 0;
};

// `labels` has a frame for each of the view's. Cost: linear.
FootSkate MeasureSkate(const FeetView& view, const ContactLabels& labels);
Penetration MeasurePenetration(const FeetView& view);

}  // namespace gelenk

#endif  // GELENK_CONTACT_FOOT_SKATE_H_
