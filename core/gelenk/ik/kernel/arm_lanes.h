// Many poses of one arm side by side, one a lane: each lane takes the steps of
// arm_descent.cc towards a target of its own.
//
// For the kernels only, like base/kernel/lanes.h.
#ifndef GELENK_IK_KERNEL_ARM_LANES_H_
#define GELENK_IK_KERNEL_ARM_LANES_H_

#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/arm_layout.h"
#include "gelenk/ik/kernel/arm_policy.h"
#include "gelenk/ik/kernel/rotation_residual.h"
#include "gelenk/ik/kernel/small_system.h"

namespace gelenk::kernel {
namespace {

// kRows is 3 where the rotation is free. kPlain: the arm's joints all turn and
// have stiffness 1, and all rows have weight 1.
template <int kCount, int kRows, bool kPlain>
class ArmLanes {
 public:
  using Vector = Lanes<kCount>;
  using Pack = typename Vector::Pack;
  using Mask = typename Vector::Mask;

  ArmLanes(const ArmLayout& arm, const ArmSettings& settings)
      : arm_(arm), settings_(settings) {}

  GELENK_INLINE void SetTarget(int lane, const ArmTarget& target) {
    for (int k = 0; k < 9; ++k) wanted_[k][lane] = target.world_rotation[k];
    for (int k = 0; k < 3; ++k) {
      wanted_[9 + k][lane] = target.world_translation[k];
    }
  }
  GELENK_INLINE void SetPose(int lane, const ArmRow& q) {
    for (int i = 0; i < arm_.joint_count; ++i) q_[i][lane] = q[i];
  }
  GELENK_INLINE void GetPose(int lane, ArmRow& q) const {
    for (int i = 0; i < arm_.joint_count; ++i) q[i] = q_[i][lane];
  }
  ArmErrors errors(int lane) const {
    return {energy_[lane], position2_[lane], rotation2_[lane]};
  }
  const Pack& energy() const { return energy_; }

  // Lanes whose pose is within tolerance; so written that NaN is not.
  GELENK_INLINE unsigned Converged() const {
    return Vector::Bits((position2_ <= settings_.position_tolerance2) &
                        (rotation2_ <= settings_.rotation_tolerance2));
  }

  // Where the poses are, and how far from their targets.
  GELENK_INLINE void Look() {
    Forward();
    FindResidual();
  }

  // One damped step in every lane.
  GELENK_INLINE void Step() {
    SmallSystem<kCount, kRows> system;
    system.Clear();
    Pack push_rows[kRows];
    for (int r = 0; r < kRows; ++r) push_rows[r] = Scale(r) * rows_[r];
    Pack columns[kMaxArmJoints][kRows];
    for (int i = 0; i < arm_.joint_count; ++i) {
      Pack column[6];
      FindColumn(i, column);
      Block(i, push_rows, column);
      for (int r = 0; r < kRows; ++r) {
        columns[i][r] = column[r];
        for (int c = 0; c <= r; ++c) system.a[r][c] += column[r] * column[c];
      }
    }
    if (!kPlain) {
      for (int r = 0; r < kRows; ++r) {
        for (int c = 0; c <= r; ++c) system.a[r][c] *= Scale(r) * Scale(c);
      }
    }
    system.Factorize(kArmDampingPerEnergy * energy_ + kArmDampingFloor);
    Pack y[kRows];
    for (int r = 0; r < kRows; ++r) y[r] = rows_[r];
    system.Solve(y);
    for (int r = 0; r < kRows; ++r) y[r] *= Scale(r);
    for (int i = 0; i < arm_.joint_count; ++i) {
      Pack step = columns[i][0] * y[0];
      for (int r = 1; r < kRows; ++r) step += columns[i][r] * y[r];
      if (!kPlain) step *= arm_.ease[i];
      const Pack lower = Vector::All(settings_.lower[i]);
      const Pack upper = Vector::All(settings_.upper[i]);
      q_[i] = Vector::Min(Vector::Max(q_[i] + step, lower), upper);
    }
  }

 private:
  GELENK_INLINE double Scale(int row) const {
    if (kPlain) return 1;
    return row < 3 ? settings_.translation_scale[row]
                   : settings_.rotation_scale;
  }

  GELENK_INLINE void Forward() {
    Pack sines[kMaxArmJoints], cosines[kMaxArmJoints];
    for (int i = 0; i < arm_.joint_count; ++i) {
      const Pack turned = kPlain ? q_[i] : q_[i] * arm_.turn[i];
      Vector::SineCosine(turned + arm_.offset[i], &sines[i], &cosines[i]);
    }
    Pack x[3], y[3], z[3], p[3];
    for (int a = 0; a < 3; ++a) {
      x[a] = Vector::All(settings_.world_from_first_rotation[3 * a]);
      y[a] = Vector::All(settings_.world_from_first_rotation[3 * a + 1]);
      z[a] = Vector::All(settings_.world_from_first_rotation[3 * a + 2]);
      p[a] = Vector::All(settings_.world_from_first_translation[a]);
    }
    for (int i = 0; i < arm_.joint_count; ++i) {
      for (int a = 0; a < 3; ++a) {
        axes_[i][a] = z[a];
        origins_[i][a] = p[a];
        const Pack turned = cosines[i] * x[a] + sines[i] * y[a];
        y[a] = cosines[i] * y[a] - sines[i] * x[a];
        x[a] = turned;
      }
      // Zeros are frequent, and the same ones in every iteration.
      if (arm_.x[i] != 0) Move(p, x, Vector::All(arm_.x[i]));
      if (arm_.y[i] != 0) Move(p, y, Vector::All(arm_.y[i]));
      if (!kPlain) {
        Move(p, z, arm_.z[i] + (1 - arm_.turn[i]) * q_[i]);
      } else if (arm_.z[i] != 0) {
        Move(p, z, Vector::All(arm_.z[i]));
      }
      Twist(arm_.cos_twist[i], arm_.sin_twist[i], y, z);
    }
    for (int a = 0; a < 3; ++a) {
      tip_[3 * a] = x[a], tip_[3 * a + 1] = y[a], tip_[3 * a + 2] = z[a];
      tip_[9 + a] = p[a];
    }
  }

  static GELENK_INLINE void Move(Pack* p, const Pack* axis, const Pack& way) {
    for (int a = 0; a < 3; ++a) p[a] += way * axis[a];
  }

  // Turns y and z about x; most arms have right angles only.
  static GELENK_INLINE void Twist(double c, double s, Pack* y, Pack* z) {
    if (s == 0 && c == 1) return;
    for (int a = 0; a < 3; ++a) {
      const Pack from = y[a];
      if (c == 0 && s == 1) {
        y[a] = z[a], z[a] = -from;
      } else if (c == 0 && s == -1) {
        y[a] = -z[a], z[a] = from;
      } else {
        y[a] = c * from + s * z[a];
        z[a] = c * z[a] - s * from;
      }
    }
  }

  GELENK_INLINE void FindResidual() {
    Pack weighted2 = {};
    position2_ = Pack{};
    for (int k = 0; k < 3; ++k) {
      const Pack way = wanted_[9 + k] - tip_[9 + k];
      rows_[k] = Scale(k) * way;
      weighted2 += rows_[k] * rows_[k];
      position2_ += settings_.translation_counts[k] * way * way;
    }
    rotation2_ = Pack{};
    if (kRows == 6) {
      FindTurn();
      for (int k = 3; k < 6; ++k) {
        rotation2_ += rows_[k] * rows_[k];
        rows_[k] *= Scale(k);
      }
      weighted2 += Scale(3) * Scale(3) * rotation2_;
    }
    energy_ = 0.5 * weighted2;
  }

  // rows 3 to 5, unweighted.
  GELENK_INLINE void FindTurn() {
    Pack trace1 = Vector::All(1);
    Pack turn[3];
    for (int a = 0; a < 3; ++a) {
      const Pack* next = tip_ + 3 * ((a + 1) % 3);
      const Pack* last = tip_ + 3 * ((a + 2) % 3);
      const Pack* wanted_next = wanted_ + 3 * ((a + 1) % 3);
      const Pack* wanted_last = wanted_ + 3 * ((a + 2) % 3);
      turn[a] = Pack{};
      for (int k = 0; k < 3; ++k) {
        turn[a] += next[k] * wanted_last[k] - last[k] * wanted_next[k];
        trace1 += tip_[3 * a + k] * wanted_[3 * a + k];
      }
    }
    const Pack scale = 1.0 / Vector::SquareRoot(trace1);
    for (int a = 0; a < 3; ++a) rows_[3 + a] = turn[a] * scale;
    unsigned half_turns = Vector::Bits(trace1 <= kNearHalfTurn);
    if (__builtin_expect(half_turns != 0, 0)) {
      for (; half_turns != 0; half_turns &= half_turns - 1) {
        FindHalfTurn(__builtin_ctz(half_turns));
      }
    }
  }

  __attribute__((noinline)) void FindHalfTurn(int lane) {
    double d[9], e[3];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        d[3 * i + j] = 0;
        for (int k = 0; k < 3; ++k) {
          d[3 * i + j] += wanted_[3 * i + k][lane] * tip_[3 * j + k][lane];
        }
      }
    }
    HalfTurnResidual(d, e);
    for (int k = 0; k < 3; ++k) rows_[3 + k][lane] = e[k];
  }

  // What joint i does to the tip: of the Jacobian, unweighted.
  GELENK_INLINE void FindColumn(int i, Pack* column) const {
    const Pack* axis = axes_[i];
    Pack arm[3];
    for (int a = 0; a < 3; ++a) arm[a] = tip_[9 + a] - origins_[i][a];
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      column[a] = axis[b] * arm[c] - axis[c] * arm[b];
      column[3 + a] = axis[a];
    }
    if (kPlain) return;
    const double turns = arm_.turn[i] * arm_.ease[i];
    for (int a = 0; a < 3; ++a) {
      column[a] = turns * column[a] + (arm_.ease[i] - turns) * axis[a];
      column[3 + a] *= turns;
    }
  }

  // Zeros it in lanes where the joint is at a bound and pushed outwards.
  GELENK_INLINE void Block(int i, const Pack* push_rows, Pack* column) const {
    Pack push = column[0] * push_rows[0];
    for (int r = 1; r < kRows; ++r) push += column[r] * push_rows[r];
    const double lower = settings_.lower[i], upper = settings_.upper[i];
    Mask blocked =
        ((q_[i] <= lower) & (push < 0)) | ((q_[i] >= upper) & (push > 0));
    if (lower == upper) blocked = ~Mask{};
    for (int r = 0; r < kRows; ++r)
      column[r] = Vector::Select(blocked, Pack{}, column[r]);
  }

  const ArmLayout& arm_;
  const ArmSettings& settings_;
  // Frames: a rotation row by row, then an origin.
  Pack wanted_[12];
  Pack tip_[12];
  Pack q_[kMaxArmJoints];
  Pack axes_[kMaxArmJoints][3];
  Pack origins_[kMaxArmJoints][3];
  Pack rows_[6];
  Pack energy_;
  Pack position2_;
  Pack rotation2_;
};

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_ARM_LANES_H_
