// The contacts of a whole clip: what the online detector finds, but with
// speeds centred in time, one floor, gaps filled and flickers dropped.
#ifndef GELENK_CONTACT_CONTACT_LABELS_H_
#define GELENK_CONTACT_CONTACT_LABELS_H_

#include <vector>

#include "absl/types/span.h"
#include "gelenk/contact/contact_detector.h"

namespace gelenk {

struct ContactLabels {
  std::vector<FootContacts> frames;
  // The estimated floor and the height of each planted point above it; zero
  // where the ground is known.
  double floor_m = 0;
  PerFootPoint<double> bias_m = {};

  // Part of all frames of heels and balls that are in contact.
  double ContactRatio() const;
};

// Clips shorter than this have no contacts: speed says nothing.
inline constexpr int kMinContactFrames = 4;

// `ground` may be null: then the floor is estimated. Cost: linear but for the
// medians.
ContactLabels LabelContacts(absl::Span<const FootPoints> frames,
                            double frame_time_s, const FeetGeometry& feet,
                            const Ground* ground = nullptr,
                            const ContactThresholds& thresholds = {});

}  // namespace gelenk

#endif  // GELENK_CONTACT_CONTACT_LABELS_H_
