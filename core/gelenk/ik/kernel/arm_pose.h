// One pose of an arm: forward kinematics, and how far its tip is from a target.
// Vectors of space take four lanes, of which the last is 0; sines and cosines
// of all joints are taken side by side.
//
// For the kernels only, like base/kernel/lanes.h.
#ifndef GELENK_IK_KERNEL_ARM_POSE_H_
#define GELENK_IK_KERNEL_ARM_POSE_H_

#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/arm_layout.h"
#include "gelenk/ik/kernel/arm_policy.h"
#include "gelenk/ik/kernel/rotation_residual.h"

namespace gelenk::kernel {
namespace {

using Quad = PackOf<4>::Pack;

GELENK_INLINE Quad QuadOf(const double* v) { return Quad{v[0], v[1], v[2], 0}; }

GELENK_INLINE Quad LoadQuad(const double* from) {
  return *reinterpret_cast<const Quad*>(from);
}
GELENK_INLINE void StoreQuad(Quad quad, double* to) {
  *reinterpret_cast<Quad*>(to) = quad;
}

// y z x
GELENK_INLINE Quad Cycle(Quad v) {
  return __builtin_shufflevector(v, v, 1, 2, 0, 3);
}
GELENK_INLINE Quad Cross(Quad a, Quad b) {
  return Cycle(a * Cycle(b) - Cycle(a) * b);
}
GELENK_INLINE double Dot(Quad a, Quad b) {
  const Quad product = a * b;
  return product[0] + product[1] + product[2];
}

GELENK_INLINE void CopyRow(const ArmRow& from, int count, ArmRow& to) {
  for (int i = 0; i < count; i += 4) {
    StoreQuad(LoadQuad(from.values + i), to.values + i);
  }
}

struct QuadFrame {
  Quad axes[3];
  Quad origin;
};

GELENK_INLINE QuadFrame FrameOf(const Matrix3& rotation,
                                const Vector3& translation) {
  QuadFrame frame;
  for (int k = 0; k < 3; ++k) {
    frame.axes[k] = Quad{rotation[k], rotation[3 + k], rotation[6 + k], 0};
  }
  frame.origin = QuadOf(translation);
  return frame;
}

// kWidth is the width of vectors across joints.
template <int kWidth>
struct ArmPose {
  using Vector = Lanes<kWidth>;
  static_assert(kMaxArmJoints % kWidth == 0);

  ArmPose(const ArmLayout& layout, const ArmSettings& settings,
          const ArmRow& start)
      : arm(layout),
        first(FrameOf(settings.world_from_first_rotation,
                      settings.world_from_first_translation)),
        q(start) {}

  // Fills axes, origins and tip from q.
  GELENK_INLINE void Forward() {
    // Of each joint, in the frame before it turns: the next joint's axes but
    // for what does not turn, and its origin.
    ArmRow xx, xy, yx, yy, zx, zy, tx, ty, tz;
    for (int i = 0; i < arm.joint_count; i += kWidth) {
      const auto load = [i](const ArmRow& row) {
        return Vector::Load(row.values + i);
      };
      const auto store = [i](const typename Vector::Pack& pack, ArmRow& row) {
        Vector::Store(pack, row.values + i);
      };
      const typename Vector::Pack turned = load(arm.turn) * load(q);
      typename Vector::Pack s, c;
      Vector::SineCosine(turned + load(arm.offset), &s, &c);
      store(c, xx);
      store(s, xy);
      store(-s * load(arm.cos_twist), yx);
      store(c * load(arm.cos_twist), yy);
      store(s * load(arm.sin_twist), zx);
      store(-c * load(arm.sin_twist), zy);
      store(c * load(arm.x) - s * load(arm.y), tx);
      store(s * load(arm.x) + c * load(arm.y), ty);
      store(load(arm.z) + (load(q) - turned), tz);
    }
    QuadFrame f = first;
    for (int i = 0; i < arm.joint_count; ++i) {
      const Quad x = f.axes[0], y = f.axes[1], z = f.axes[2];
      axes[i] = z;
      origins[i] = f.origin;
      f.origin += tx[i] * x + ty[i] * y + tz[i] * z;
      f.axes[0] = xx[i] * x + xy[i] * y;
      f.axes[1] = yx[i] * x + yy[i] * y + arm.sin_twist[i] * z;
      f.axes[2] = zx[i] * x + zy[i] * y + arm.cos_twist[i] * z;
    }
    tip = f;
  }

  const ArmLayout& arm;
  const QuadFrame first;
  ArmRow q;
  // World frame, before each joint moves.
  Quad axes[kMaxArmJoints];
  Quad origins[kMaxArmJoints];
  QuadFrame tip;
};

// The way from a pose's tip to the target.
struct ArmResidual {
  double rows[6];  // weighted: m, then 2 sin(angle / 2) about the axis
  ArmErrors errors;
  // The energy once more, good to 1e-15 only but known sooner.
  double early_energy;
};

// d = to * from^T, row-major.
GELENK_INLINE void TurnBetween(const QuadFrame& from, const QuadFrame& to,
                               double* d) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      d[3 * i + j] = to.axes[0][i] * from.axes[0][j] +
                     to.axes[1][i] * from.axes[1][j] +
                     to.axes[2][i] * from.axes[2][j];
    }
  }
}

// kRows is 3 where the rotation is free.
template <int kRows>
GELENK_INLINE void FindResidual(const QuadFrame& tip, const QuadFrame& wanted,
                                const ArmSettings& settings,
                                ArmResidual& residual) {
  double* rows = residual.rows;
  const Quad way = wanted.origin - tip.origin;
  double position2 = 0, weighted2 = 0, early2 = 0;
  for (int k = 0; k < 3; ++k) {
    rows[k] = settings.translation_scale[k] * way[k];
    position2 += settings.translation_counts[k] * way[k] * way[k];
    weighted2 += rows[k] * rows[k];
  }
  early2 = weighted2;
  double rotation2 = 0;
  if (kRows == 6) {
    const Quad cosines = tip.axes[0] * wanted.axes[0] +
                         tip.axes[1] * wanted.axes[1] +
                         tip.axes[2] * wanted.axes[2];
    const double trace1 = 1 + cosines[0] + cosines[1] + cosines[2];
    if (__builtin_expect(trace1 > kNearHalfTurn, 1)) {
      const Quad turn = Cross(tip.axes[0], wanted.axes[0]) +
                        Cross(tip.axes[1], wanted.axes[1]) +
                        Cross(tip.axes[2], wanted.axes[2]);
      const double scale = 1 / __builtin_sqrt(trace1);
      for (int k = 0; k < 3; ++k) rows[3 + k] = turn[k] * scale;
    } else {
      double d[9];
      TurnBetween(tip, wanted, d);
      HalfTurnResidual(d, rows + 3);
    }
    const double scale = settings.rotation_scale;
    for (int k = 3; k < 6; ++k) {
      rotation2 += rows[k] * rows[k];
      rows[k] *= scale;
    }
    weighted2 += scale * scale * rotation2;
    early2 += scale * scale * (4 - trace1);
  }
  residual.errors = {0.5 * weighted2, position2, rotation2};
  residual.early_energy = 0.5 * early2;
}

// So written that NaN is not within.
GELENK_INLINE bool IsWithin(const ArmErrors& errors,
                            const ArmSettings& settings) {
  return errors.position2 <= settings.position_tolerance2 &&
         errors.rotation2 <= settings.rotation_tolerance2;
}

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_ARM_POSE_H_
