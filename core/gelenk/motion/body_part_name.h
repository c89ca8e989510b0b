// What the name of a joint says about its place on a body.
#ifndef GELENK_MOTION_BODY_PART_NAME_H_
#define GELENK_MOTION_BODY_PART_NAME_H_

#include "absl/strings/string_view.h"

namespace gelenk {

enum class BodySide { kNone, kLeft, kRight };
enum class BodyPart { kOther, kHips, kRoot, kHand, kFoot, kHead };

struct BodyPartName {
  BodySide side = BodySide::kNone;
  BodyPart part = BodyPart::kOther;
};

// "mixamorig:LeftHand", "hand_l", "Bip01 L Hand", "lhand" are left hands;
// fingers, toes, ends, props, controls and the scalar joints of a chain
// ("LeftHand.Xrotation") are other.
BodyPartName ReadBodyPartName(absl::string_view name);

}  // namespace gelenk

#endif  // GELENK_MOTION_BODY_PART_NAME_H_
