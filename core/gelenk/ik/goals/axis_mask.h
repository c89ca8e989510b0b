// Which axes of the world count in a residual.
#ifndef GELENK_IK_GOALS_AXIS_MASK_H_
#define GELENK_IK_GOALS_AXIS_MASK_H_

namespace gelenk {

// Of a translation each axis counts by itself. Of a rotation: with all three,
// the whole angle to the target; with two, the angle by which the third axis,
// as the target has it, is tilted; with one, the twist about it; with none,
// nothing.
struct AxisMask {
  bool x = true;
  bool y = true;
  bool z = true;

  int count() const { return int{x} + int{y} + int{z}; }
};

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_AXIS_MASK_H_
