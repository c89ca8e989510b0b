// Which side of a body is left, where no name tells.
//
// Rest poses mislead: they may lie, or have all bones along one axis. In motion
// a body's toes point forward, and its left is up x forward.
#ifndef GELENK_RETARGET_SIDE_CHECK_H_
#define GELENK_RETARGET_SIDE_CHECK_H_

#include "gelenk/retarget/clip_view.h"
#include "gelenk/retarget/joint_map.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct SwappedSides {
  bool legs = false;
  bool arms = false;
};

// Whether the limbs of `map` are on the wrong sides, on average over at most
// 100 frames of `clip`. Nothing is where the body has no toes, or where it is
// not clear.
SwappedSides CheckSides(const Skeleton& skeleton, const JointMap& map,
                        const ClipView& clip);

}  // namespace gelenk

#endif  // GELENK_RETARGET_SIDE_CHECK_H_
