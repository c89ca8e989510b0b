// The inner loop of KinematicTree, compiled once per level of the instruction
// set: GELENK_KERNEL_LEVEL names the level, GELENK_KERNEL_LANES is its vector
// width in doubles.
#include "gelenk/base/kernel/lanes.h"
#include "gelenk/kinematics/kernel/forward_layout.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// Four lanes at most: eight are no faster on 60 joints, and slower on 7.
constexpr int kWidth = GELENK_KERNEL_LANES < 4 ? GELENK_KERNEL_LANES : 4;
static_assert(kAngleBlock % kWidth == 0);
static_assert(kColumnSize % kWidth == 0);
using Vector = Lanes<kWidth>;
// A frame is worked on in parts: kWidth rows of all its columns.
using Rows = Vector::Pack;

GELENK_INLINE Rows At(const double* numbers, int column) {
  return Vector::Load(numbers + kColumnSize * column);
}

GELENK_INLINE void Set(double* numbers, int column, const Rows& rows) {
  Vector::Store(rows, numbers + kColumnSize * column);
}

// The sines and cosines of all angles, in whole vectors.
GELENK_INLINE void Trigonometry(const ForwardLayout& layout, const double* q,
                                const ForwardWorkspace& work) {
  Rows largest = {};
  for (int b = 0; b < layout.angle_block_count; ++b) {
    const ForwardAngles& block = layout.angles[b];
    for (int i = 0; i < kAngleBlock; i += kWidth) {
      const Rows x = Vector::Gather(q, block.positions + i) *
                         Vector::Load(block.multipliers + i) +
                     Vector::Load(block.offsets + i);
      Rows s, c;
      Vector::SineCosine(x, &s, &c);
      largest = Vector::Max(largest, Vector::Abs(x));
      Vector::Store(s, work.sines + kAngleBlock * b + i);
      Vector::Store(c, work.cosines + kAngleBlock * b + i);
    }
  }
  if (Vector::Largest(largest) <= kLargestAngle) return;
  for (int k = 0; k < kAngleBlock * layout.angle_block_count; ++k) {
    const ForwardAngles& block = layout.angles[k / kAngleBlock];
    const int i = k % kAngleBlock;
    const double x =
        block.multipliers[i] * q[block.positions[i]] + block.offsets[i];
    work.sines[k] = __builtin_sin(x);
    work.cosines[k] = __builtin_cos(x);
  }
}

// In what follows `rest`, `constants` and `local` point to the rows of a part.

// local = rest * rotation about axis kAxis.
template <int kAxis>
GELENK_INLINE void TurnAligned(const double* rest, double s, double c,
                               double* local) {
  constexpr int kNext = (kAxis + 1) % 3;
  constexpr int kLast = (kAxis + 2) % 3;
  const Rows x = At(rest, kNext);
  const Rows y = At(rest, kLast);
  Set(local, kNext, c * x + s * y);
  Set(local, kLast, c * y - s * x);
  Set(local, kAxis, At(rest, kAxis));
  Set(local, 3, At(rest, 3));
}

GELENK_INLINE void TurnAny(const double* constants, double s, double c,
                           double* local) {
  for (int k = 0; k < 3; ++k) {
    Set(local, k,
        At(constants, k) + c * At(constants, 4 + k) + s * At(constants, 7 + k));
  }
  Set(local, 3, At(constants, 3));
}

GELENK_INLINE void TurnByQuaternion(const double* rest, const double* q,
                                    double* local) {
  const double x2 = q[0] + q[0], y2 = q[1] + q[1], z2 = q[2] + q[2];
  const double xx = q[0] * x2, yy = q[1] * y2, zz = q[2] * z2;
  const double xy = q[0] * y2, xz = q[0] * z2, yz = q[1] * z2;
  const double wx = q[3] * x2, wy = q[3] * y2, wz = q[3] * z2;
  const Rows x = At(rest, 0), y = At(rest, 1), z = At(rest, 2);
  Set(local, 0, x * (1 - (yy + zz)) + y * (xy + wz) + z * (xz - wy));
  Set(local, 1, x * (xy - wz) + y * (1 - (xx + zz)) + z * (yz + wx));
  Set(local, 2, x * (xz + wy) + y * (yz - wx) + z * (1 - (xx + yy)));
  Set(local, 3, At(rest, 3));
}

// local = parent_from_joint, the joint's motion included.
GELENK_INLINE void Move(const ForwardJoint& joint, const double* constants,
                        const double* q, const ForwardWorkspace& work,
                        double* local) {
  const double s = joint.angle < 0 ? 0 : work.sines[joint.angle];
  const double c = joint.angle < 0 ? 1 : work.cosines[joint.angle];
  q += joint.position;
  switch (joint.type) {
    case MotionType::kFixed:
      for (int k = 0; k < 4; ++k) Set(local, k, At(constants, k));
      break;
    case MotionType::kTurnX:
      TurnAligned<0>(constants, s, c, local);
      break;
    case MotionType::kTurnY:
      TurnAligned<1>(constants, s, c, local);
      break;
    case MotionType::kTurnZ:
      TurnAligned<2>(constants, s, c, local);
      break;
    case MotionType::kTurn:
      TurnAny(constants, s, c, local);
      break;
    case MotionType::kSlide:
      for (int k = 0; k < 3; ++k) Set(local, k, At(constants, k));
      Set(local, 3,
          At(constants, 3) +
              (joint.multiplier * q[0] + joint.offset) * At(constants, 4));
      break;
    case MotionType::kSpherical:
      TurnByQuaternion(constants, q, local);
      break;
    case MotionType::kPlanar:
      TurnAny(constants, s, c, local);
      Set(local, 3,
          At(constants, 3) + q[0] * At(constants, 10) +
              q[1] * At(constants, 11));
      break;
    case MotionType::kFree:
      TurnByQuaternion(constants, q + 3, local);
      Set(local, 3,
          At(constants, 3) + q[0] * At(constants, 0) + q[1] * At(constants, 1) +
              q[2] * At(constants, 2));
      break;
  }
}

// frame = parent * local. `local` is whole: its numbers are broadcast by the
// load, for nothing.
GELENK_INLINE void Compose(const double* parent, const double* local,
                           double* frame) {
  for (int part = 0; part < kColumnSize; part += kWidth) {
    const Rows x = At(parent + part, 0), y = At(parent + part, 1),
               z = At(parent + part, 2);
    for (int k = 0; k < 4; ++k) {
      const double* column = local + kColumnSize * k;
      Rows sum = x * column[0] + y * column[1] + z * column[2];
      if (k == 3) sum += At(parent + part, 3);
      Set(frame + part, k, sum);
    }
  }
}

// axis = the frame's rotation * direction.
GELENK_INLINE void Turn(const double* frame, const double* direction,
                        double* axis) {
  for (int part = 0; part < kColumnSize; part += kWidth) {
    Set(axis + part, 0,
        At(frame + part, 0) * direction[0] +
            At(frame + part, 1) * direction[1] +
            At(frame + part, 2) * direction[2]);
  }
}

GELENK_INLINE const double* FrameOr(const double* base, int index,
                                    const ForwardWorkspace& work) {
  return index < 0 ? base : work.frames + kFrameSize * index;
}

}  // namespace

void RunForward(const ForwardLayout& shared_layout, const double* positions,
                const double* base, const ForwardWorkspace& shared_workspace) {
  // Copies, which no store can change: so they stay in registers.
  const ForwardLayout layout = shared_layout;
  const ForwardWorkspace work = shared_workspace;
  Trigonometry(layout, positions, work);
  for (int i = 0; i < layout.joint_count; ++i) {
    const ForwardJoint& joint = layout.joints[i];
    const double* constants = layout.constants + joint.constants;
    alignas(64) double local[kFrameSize];
    for (int part = 0; part < kColumnSize; part += kWidth) {
      Move(joint, constants + part, positions, work, local + part);
    }
    Compose(FrameOr(base, joint.parent, work), local,
            work.frames + kFrameSize * i);
  }
  for (int i = 0; i < layout.axis_count; ++i) {
    const ForwardAxis& axis = layout.axes[i];
    Turn(FrameOr(base, axis.frame, work), axis.direction,
         work.axes + kColumnSize * i);
  }
}

}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL
