// Which joints of a skeleton are a body's hips, hands, feet and head.
//
// Names decide where they say it, in the manner of any common rig (LeftHand,
// lHand, hand_l, "Bip01 L Hand", mixamorig:LeftHand, LWrist); else the shape:
// two pairs of chains of the same lengths, of which the pair that meets nearer
// to the root are the legs.
#ifndef GELENK_MOTION_BODY_PARTS_H_
#define GELENK_MOTION_BODY_PARTS_H_

#include "absl/strings/string_view.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// Joint indices; -1 where there is none.
struct BodyParts {
  int hips = -1;
  int left_hand = -1;
  int right_hand = -1;
  int left_foot = -1;
  int right_foot = -1;
  int head = -1;

  // What told them.
  enum class Evidence { kNone, kNames, kShape, kNamesAndShape };
  Evidence evidence = Evidence::kNone;

  bool IsComplete() const { return hips >= 0 && HasLimbs() && head >= 0; }
  bool HasLimbs() const {
    return left_hand >= 0 && right_hand >= 0 && left_foot >= 0 &&
           right_foot >= 0;
  }
};

// "names", "shape" ...
absl::string_view EvidenceName(BodyParts::Evidence evidence);

// A hand is the joint that moves the palm (the wrist), a foot the one that
// moves the sole (the ankle); never a finger, a toe or the end of a chain.
// Lengths are those of the rest pose. Cost: linear in the joints by names;
// by shape it compares at most 64 * 64 chains.
BodyParts FindBodyParts(const Skeleton& skeleton);

}  // namespace gelenk

#endif  // GELENK_MOTION_BODY_PARTS_H_
