// The data that forward kinematics works on: flat, plain, no library type, so
// that it can be compiled once per level of the instruction set.
//
// A frame is a 4 x 4 matrix, column by column: three axes and the origin. So a
// column fits a vector register, and the product of two frames is twelve
// multiply-adds. A joint's own frame is parent_from_rest times its motion; that
// product is taken before the parent's frame is needed, so that a chain waits
// only for three multiply-adds a joint.
#ifndef GELENK_KINEMATICS_KERNEL_FORWARD_LAYOUT_H_
#define GELENK_KINEMATICS_KERNEL_FORWARD_LAYOUT_H_

#include <cstdint>

namespace gelenk::kernel {

// Numbers of a frame and of one of its columns.
inline constexpr int kFrameSize = 16;
inline constexpr int kColumnSize = 4;
// Angles come in whole vectors of the widest level.
inline constexpr int kAngleBlock = 8;

enum class MotionType : uint8_t {
  kFixed,
  kTurnX,  // about an axis of the joint's frame
  kTurnY,
  kTurnZ,
  kTurn,  // about any other axis
  kSlide,
  kSpherical,
  kPlanar,
  kFree,
};

// Constants of a joint: parent_from_rest, then by type
//   kTurn, kPlanar  what the cosine and what the sine multiplies, three columns
//                   each; the rest's own columns hold what neither does
//   kPlanar         then u and v in the parent's frame
//   kSlide          the axis in the parent's frame
struct ForwardJoint {
  int parent;     // -1 for the base
  int constants;  // where they start
  int position;   // first number in q, 0 for none
  int angle;      // index of its angle, -1 for none
  MotionType type;
  // kSlide: the way is multiplier * q[position] + offset, m.
  double multiplier;
  double offset;
};

// Eight angles: multiplier * q[position] + offset. Those of no joint are of any
// number.
struct alignas(64) ForwardAngles {
  double multipliers[kAngleBlock];
  double offsets[kAngleBlock];
  int positions[kAngleBlock];
};

// An axis that is no column of a frame: frame's rotation * direction.
struct ForwardAxis {
  double direction[kColumnSize];
  int frame;  // -1 for the base
};

struct ForwardLayout {
  const ForwardJoint* joints;
  const ForwardAngles* angles;
  const ForwardAxis* axes;
  const double* constants;
  int joint_count;
  int angle_block_count;
  int axis_count;
};

// All 64-byte aligned.
struct ForwardWorkspace {
  double* frames;   // kFrameSize * joint_count; out
  double* axes;     // kColumnSize * axis_count; out
  double* sines;    // kAngleBlock * angle_block_count
  double* cosines;  // as many
};

// `base` is world_from_skeleton, a frame, 64-byte aligned.
using ForwardFunction = void (*)(const ForwardLayout& layout,
                                 const double* positions, const double* base,
                                 const ForwardWorkspace& workspace);

namespace baseline {
void RunForward(const ForwardLayout&, const double*, const double*,
                const ForwardWorkspace&);
}
namespace avx2 {
void RunForward(const ForwardLayout&, const double*, const double*,
                const ForwardWorkspace&);
}
namespace avx512 {
void RunForward(const ForwardLayout&, const double*, const double*,
                const ForwardWorkspace&);
}

}  // namespace gelenk::kernel

#endif  // GELENK_KINEMATICS_KERNEL_FORWARD_LAYOUT_H_
