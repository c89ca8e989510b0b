// Damped least squares on an arm, for the shortest time from a target to its
// answer: one pose at a time, compiled once per level of the instruction set
// (see base/kernel/lanes.h).
//
// With n joints and m <= 6 rows the Levenberg-Marquardt step
//   (J^T J + lambda S) dq = J^T e  is  dq = S^-1 J^T (J S^-1 J^T + lambda I)^-1
//   e,
// which takes an m x m system whatever n is. What is left of an iteration's
// time is waiting: for sines, for one joint's frame after another, for the
// pivots of that system. The last step takes up the factorisation of the one
// before, where that is sure to be enough.
#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/arm_layout.h"
#include "gelenk/ik/kernel/arm_policy.h"
#include "gelenk/ik/kernel/arm_pose.h"
#include "gelenk/ik/kernel/small_system.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// Wider vectors only wait longer for the stores that they are loaded from.
constexpr int kWidth = GELENK_KERNEL_LANES < 4 ? GELENK_KERNEL_LANES : 4;

// A step that takes up the last factorisation leaves about e^2 / e_before, as
// Newton's would; it is taken where so many times that is within tolerance.
constexpr double kReuseMargin = 3;

template <int kRows>
class Descent {
 public:
  Descent(const ArmLayout& arm, const ArmSettings& settings,
          const ArmTarget& target, const ArmRow& q)
      : arm_(arm),
        settings_(settings),
        wanted_(FrameOf(target.world_rotation, target.world_translation)),
        pose_(arm, settings, q),
        best_(q) {
    // Joints are stepped in fours.
    for (int i = arm.joint_count; i % 4 != 0; ++i) {
      translation_columns_[i] = rotation_columns_[i] = Quad{};
    }
  }

  ArmAttempt Run() {
    ArmAttempt attempt = {AttemptEnd::kIterations, 0, 0, {}, false};
    double window_energy = 0;
    double energy_before = 0;
    bool factorized = false;
    for (int iteration = 0;; ++iteration) {
      pose_.Forward();
      FindResidual<kRows>(pose_.tip, wanted_, settings_, residual_);
      const double energy = residual_.errors.energy;
      attempt.iterations = iteration;
      if (IsWithin(residual_.errors, settings_)) {
        attempt.end = AttemptEnd::kConverged;
        attempt.errors = residual_.errors;
        CopyRow(pose_.q, arm_.joint_count, best_);
        return attempt;
      }
      if (iteration == 0 || energy < attempt.errors.energy) {
        attempt.errors = residual_.errors;
        CopyRow(pose_.q, arm_.joint_count, best_);
      }
      if (iteration >= settings_.max_iterations) return attempt;
      if (IsToStop(settings_)) {
        attempt.end = AttemptEnd::kStopped;
        return attempt;
      }
      if (iteration % kArmWindow == 0) {
        if (iteration > 0 && !(energy <= kArmWindowGain * window_energy)) {
          attempt.end = AttemptEnd::kImpatient;
          return attempt;
        }
        window_energy = energy;
      }
      if (factorized && IsLastStep(energy, energy_before)) {
        factorized = false;
      } else {
        Linearize();
        factorized = true;
      }
      energy_before = energy;
      Step();
    }
  }

  const ArmRow& best() const { return best_; }

 private:
  bool IsLastStep(double energy, double energy_before) const {
    const double tolerance2 =
        settings_.position_tolerance2 < settings_.rotation_tolerance2
            ? settings_.position_tolerance2
            : settings_.rotation_tolerance2;
    return kReuseMargin * kReuseMargin * energy * energy <
           energy_before * 0.5 * tolerance2;
  }

  void Linearize() {
    const int n = arm_.joint_count;
    for (int i = 0; i < n; ++i) {
      const Quad axis = pose_.axes[i];
      const Quad arm = Cross(axis, pose_.tip.origin - pose_.origins[i]);
      const double turns = arm_.turn[i] * arm_.ease[i];
      translation_columns_[i] = turns * arm + (arm_.ease[i] - turns) * axis;
      rotation_columns_[i] = turns * axis;
    }
    Block();
    Quad pp[3] = {}, rp[3] = {}, rr[3] = {};
    for (int i = 0; i < n; ++i) {
      const Quad p = translation_columns_[i], r = rotation_columns_[i];
      for (int k = 0; k < 3; ++k) {
        pp[k] += p * p[k];
        if (kRows == 6) rp[k] += r * p[k];
        if (kRows == 6) rr[k] += r * r[k];
      }
    }
    const double* s = settings_.translation_scale;
    const double turn = settings_.rotation_scale;
    for (int c = 0; c < 3; ++c) {
      pp[c] *= QuadOf(s) * s[c];
      for (int r = c; r < 3; ++r) system_.a[r][c] = pp[c][r];
      if constexpr (kRows == 6) {
        rp[c] *= turn * s[c];
        rr[c] *= turn * turn;
        for (int r = 0; r < 3; ++r) system_.a[3 + r][c] = rp[c][r];
        for (int r = c; r < 3; ++r) system_.a[3 + r][3 + c] = rr[c][r];
      }
    }
    system_.Factorize(kArmDampingPerEnergy * residual_.early_energy +
                      kArmDampingFloor);
  }

  // Joints at a bound that are pushed outwards do not move in this step.
  GELENK_INLINE void Block() {
    unsigned at_bound = 0;
    for (int i = 0; i < arm_.joint_count; i += 4) {
      const Quad q = LoadQuad(pose_.q.values + i);
      at_bound |= Lanes<4>::Bits((q <= LoadQuad(settings_.lower.values + i)) |
                                 (q >= LoadQuad(settings_.upper.values + i)))
                  << i;
    }
    if (__builtin_expect(at_bound != 0, 0)) BlockJoints(at_bound);
  }

  __attribute__((noinline)) void BlockJoints(unsigned at_bound) {
    const double* e = residual_.rows;
    const double* s = settings_.translation_scale;
    for (; at_bound != 0; at_bound &= at_bound - 1) {
      const int i = __builtin_ctz(at_bound);
      double push = 0;
      for (int k = 0; k < 3; ++k) {
        push += translation_columns_[i][k] * s[k] * e[k];
        if (kRows == 6) {
          push += rotation_columns_[i][k] * settings_.rotation_scale * e[3 + k];
        }
      }
      const double lower = settings_.lower[i], upper = settings_.upper[i];
      if ((pose_.q[i] <= lower && push < 0) ||
          (pose_.q[i] >= upper && push > 0) || lower == upper) {
        translation_columns_[i] = rotation_columns_[i] = Quad{};
      }
    }
  }

  void Step() {
    double y[6] = {};
    for (int r = 0; r < kRows; ++r) y[r] = residual_.rows[r];
    system_.Solve(y);
    for (int k = 0; k < 3; ++k) {
      y[k] *= settings_.translation_scale[k];
      y[3 + k] *= settings_.rotation_scale;
    }
    const Quad y_translation = QuadOf(y), y_rotation = QuadOf(y + 3);
    const auto products = [&](int i) {
      Quad product = translation_columns_[i] * y_translation;
      if (kRows == 6) product += rotation_columns_[i] * y_rotation;
      return product;
    };
    for (int i = 0; i < arm_.joint_count; i += 4) {
      const Quad step =
          Sums(products(i), products(i + 1), products(i + 2), products(i + 3));
      const Quad q =
          LoadQuad(pose_.q.values + i) + LoadQuad(arm_.ease.values + i) * step;
      const Quad lower = LoadQuad(settings_.lower.values + i);
      const Quad upper = LoadQuad(settings_.upper.values + i);
      const Quad above = q < lower ? lower : q;
      StoreQuad(above > upper ? upper : above, pose_.q.values + i);
    }
  }

  // The sum of each one's lanes.
  static GELENK_INLINE Quad Sums(Quad a, Quad b, Quad c, Quad d) {
    const Quad ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) +
                    __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const Quad cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) +
                    __builtin_shufflevector(c, d, 1, 5, 3, 7);
    return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) +
           __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
  }

  const ArmLayout& arm_;
  const ArmSettings& settings_;
  const QuadFrame wanted_;
  ArmPose<kWidth> pose_;
  ArmRow best_;
  ArmResidual residual_;
  // Of the Jacobian, unweighted, zero where blocked.
  Quad translation_columns_[kMaxArmJoints];
  Quad rotation_columns_[kMaxArmJoints];
  SmallSystem<1, kRows> system_;
};

template <int kRows>
ArmAttempt Descend(const ArmLayout& arm, const ArmSettings& settings,
                   const ArmTarget& target, ArmRow& q) {
  Descent<kRows> descent(arm, settings, target, q);
  const ArmAttempt attempt = descent.Run();
  q = descent.best();
  return attempt;
}

}  // namespace

ArmAttempt DescendArm(const ArmLayout& arm, const ArmSettings& settings,
                      const ArmTarget& target, ArmRow& q) {
  if (settings.rotation_scale == 0) {
    return Descend<3>(arm, settings, target, q);
  }
  return Descend<6>(arm, settings, target, q);
}

}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL
