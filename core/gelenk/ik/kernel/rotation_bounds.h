// What the inner loop needs to know about a rotation that touches its swing
// cone or twist range. Rare, so compiled once and called out of line.
#ifndef GELENK_IK_KERNEL_ROTATION_BOUNDS_H_
#define GELENK_IK_KERNEL_ROTATION_BOUNDS_H_

#include <cstdint>

#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel {

// Bits of Workspace::touched.
enum RotationTouch : uint8_t {
  kTouchesCone = 1,
  kTouchesTwistLower = 2,
  kTouchesTwistUpper = 4,
  kConeIsPoint = 8,  // no swing at all is allowed
};

// Which bounds `rotation` (x y z w) touches, 0 for none. If any, fills the
// columns of `body_basis` (row-major 3x3, body frame): rotating about the first
// changes the swing angle only, about the second neither swing angle nor twist,
// about the third the twist only. So in that basis the bounds are a box.
uint8_t TouchRotationLimit(const RotationLimit& limit, const double* rotation,
                           double* body_basis);

// Moves `rotation` inside, see ClampRotation.
void ClampToRotationLimit(const RotationLimit& limit, double* rotation);

}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_ROTATION_BOUNDS_H_
