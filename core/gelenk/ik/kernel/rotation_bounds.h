// What the inner loop needs to know about a rotation that touches its swing
// cone or twist range. Rare, so compiled once and called out of line.
#ifndef GELENK_IK_KERNEL_ROTATION_BOUNDS_H_
#define GELENK_IK_KERNEL_ROTATION_BOUNDS_H_

#include <cstdint>

#include "gelenk/base/kernel/inline.h"
#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel {

// Bits of Workspace::touched.
enum RotationTouch : uint8_t {
  kTouchesCone = 1,
  kTouchesTwistLower = 2,
  kTouchesTwistUpper = 4,
  kConeIsPoint = 8,  // no swing at all is allowed
};

namespace {

// True when the rotation is surely inside its limits and off their bounds.
GELENK_INLINE bool IsWellInside(const RotationLimit& limit, const double* q) {
  if (!limit.quick) return false;
  constexpr double kMargin = 1e-8;
  const double along =
      q[0] * limit.axis[0] + q[1] * limit.axis[1] + q[2] * limit.axis[2];
  const double across2 =
      q[0] * q[0] + q[1] * q[1] + q[2] * q[2] - along * along;
  if (!(across2 < limit.swing_sine2 - kMargin)) return false;
  const double w = q[3] < 0 ? -q[3] : q[3];
  const double t = q[3] < 0 ? -along : along;
  return t > limit.twist_tangent_lower * w + kMargin &&
         t < limit.twist_tangent_upper * w - kMargin;
}

// True when a rotation that touches these bounds, pushed by `g` about the
// column of its basis (see TouchRotationLimit), would leave them.
GELENK_INLINE bool BlocksTurn(uint8_t touched, int column, double g) {
  switch (column) {
    case 0:
      return (touched & kConeIsPoint) || ((touched & kTouchesCone) && g > 0);
    case 1:
      return touched & kConeIsPoint;
    default:
      return ((touched & kTouchesTwistLower) && g < 0) ||
             ((touched & kTouchesTwistUpper) && g > 0);
  }
}

}  // namespace

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
