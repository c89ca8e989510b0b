// The closest pose of an arm, by Newton's method with a region of trust: slower
// a step than arm_descent.cc, but every step is one down, a saddle is no end,
// and convergence is quadratic also where the target is out of reach. Compiled
// once per level of the instruction set (see base/kernel/lanes.h).
//
// (Nocedal, Wright, Numerical Optimization, 2006, ch. 4 and 6; the active set
// of bounds as in Bertsekas, "Projected Newton methods", 1982.)
#include "gelenk/base/kernel/scalar.h"
#include "gelenk/ik/kernel/arm_curvature.h"
#include "gelenk/ik/kernel/arm_layout.h"
#include "gelenk/ik/kernel/arm_pose.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

constexpr int kWidth = GELENK_KERNEL_LANES < 4 ? GELENK_KERNEL_LANES : 4;

// Of the mean curvature: what holds directions that change nothing.
constexpr double kLeastShift = 1e-12;
constexpr double kFirstShift = 1e-9;
constexpr double kShiftGrowth = 10;
// Beyond, even the softest joint (see SparseTree) is held by far more than any
// curvature: what is not definite then is no number.
constexpr double kMostShift = 1e9;
// Of the energy: a step that promises less ends it.
constexpr double kLeastGain = 1e-9;
// The region of trust grows, stays or shrinks by what of the promise came true.
constexpr double kTrusted = 0.75;
constexpr double kMistrusted = 0.25;
constexpr double kLeastStep = 1e-9;
constexpr double kLeastSlip = 1e-5;

class Settling {
 public:
  Settling(const ArmLayout& arm, const ArmSettings& settings,
           const ArmTarget& target, const ArmRow& q)
      : arm_(arm),
        settings_(settings),
        n_(arm.joint_count),
        wanted_(FrameOf(target.world_rotation, target.world_translation)),
        pose_(arm, settings, q) {}

  ArmAttempt Run(double max_step) {
    ArmAttempt attempt = {AttemptEnd::kIterations, 0, 0, {}, false};
    double reach = max_step;
    double shift = kFirstShift;
    ArmErrors errors = Look();
    bool known = false;
    for (;; ++attempt.iterations) {
      if (IsWithin(errors, settings_)) {
        attempt.end = AttemptEnd::kConverged;
        break;
      }
      if (!known) {
        FindCurvature(pose_, wanted_, settings_, model_);
        attempt.pushed_at_limit = Block();
        known = true;
      }
      if (attempt.iterations >= settings_.max_iterations) break;
      if (IsToStop(settings_)) {
        attempt.end = AttemptEnd::kStopped;
        break;
      }
      // The smallest shift that makes the free part definite.
      bool definite = Factorize(shift * mean_);
      while (!definite && shift < kMostShift) {
        shift *= kShiftGrowth;
        definite = Factorize(shift * mean_);
      }
      if (!definite) {
        attempt.end = AttemptEnd::kStationary;
        break;
      }
      FindStep();
      double gain = Promise();
      if (gain <= kLeastGain * errors.energy) {
        // Flat. Is it a saddle, or a bound that is in nobody's way?
        if (Slip(max_step, errors)) {
          known = false;
          shift = kFirstShift;
          continue;
        }
        attempt.end = AttemptEnd::kStationary;
        break;
      }
      double largest = 0;
      for (int i = 0; i < n_; ++i) largest = Max(largest, Abs(step_[i]));
      const double part = largest > reach ? reach / largest : 1;
      if (part < 1) {
        for (int i = 0; i < n_; ++i) step_[i] *= part;
        gain = Promise();
      }
      const ArmRow before = pose_.q;
      double moved = 0;
      for (int i = 0; i < n_; ++i) {
        const double q = Min(Max(before[i] + step_[i], settings_.lower[i]),
                             settings_.upper[i]);
        pose_.q[i] = q;
        moved = Max(moved, Abs(q - before[i]));
      }
      const ArmErrors next = Look();
      const double came = errors.energy - next.energy;
      if (!(came > 0)) {
        pose_.q = before;
        Look();
        reach = 0.25 * Min(moved, reach);
        if (reach < kLeastStep) {
          attempt.end = AttemptEnd::kStationary;
          break;
        }
        continue;
      }
      errors = next;
      known = false;
      if (came > kTrusted * gain) {
        reach = Min(2 * reach, max_step);
        shift = Max(0.1 * shift, kLeastShift);
      } else if (came < kMistrusted * gain) {
        reach = 0.5 * Min(moved, reach);
      }
    }
    attempt.errors = errors;
    return attempt;
  }

  const ArmRow& q() const { return pose_.q; }

 private:
  ArmErrors Look() {
    pose_.Forward();
    ArmResidual residual;
    FindResidual<6>(pose_.tip, wanted_, settings_, residual);
    if (settings_.rotation_scale == 0) residual.errors.rotation2 = 0;
    return residual.errors;
  }

  // Joints at a bound that are pushed outwards stay. Returns whether any is
  // pushed with force.
  bool Block() {
    double largest = 0, pushed = 0, trace = 0;
    free_count_ = 0;
    int blocked_count = 0;
    for (int i = 0; i < n_; ++i) {
      const double q = pose_.q[i], slope = model_.slope[i];
      const double lower = settings_.lower[i], upper = settings_.upper[i];
      const bool blocked = (q <= lower && slope > 0) ||
                           (q >= upper && slope < 0) || lower == upper;
      step_[i] = 0;
      if (blocked) {
        pushed = Max(pushed, Abs(slope));
        order_[n_ - ++blocked_count] = i;
        continue;
      }
      order_[free_count_++] = i;
      largest = Max(largest, Abs(slope));
      trace += Abs(model_.hessian[i][i]);
    }
    mean_ = free_count_ > 0 ? Max(trace / free_count_, 1e-300) : 1;
    return pushed > 0 && pushed > 10 * largest;
  }

  // L D L^T of the free part plus `shift` times the stiffness. False where a
  // pivot is not positive.
  bool Factorize(double shift) {
    for (int r = 0; r < free_count_; ++r) {
      FactorizeRow(r, shift);
      if (!HasFirmPivot(r, shift)) return false;
    }
    return true;
  }

  // Whether more is left of the pivot than half of what the shift gave it.
  bool HasFirmPivot(int r, double shift) const {
    return pivots_[r] > 0.5 * Shift(order_[r], shift);
  }

  double Shift(int i, double shift) const {
    return shift / (arm_.ease[i] * arm_.ease[i]);
  }

  // Row r, those above it being done.
  void FactorizeRow(int r, double shift) {
    const int i = order_[r];
    for (int c = 0; c <= r; ++c) {
      double sum = Hessian(i, order_[c]);
      if (c == r) sum += Shift(i, shift);
      for (int k = 0; k < c; ++k) {
        sum -= factor_[r][k] * factor_[c][k] * pivots_[k];
      }
      if (c == r) {
        pivots_[r] = sum;
      } else {
        factor_[r][c] = sum / pivots_[c];
      }
    }
  }

  double Hessian(int i, int j) const {
    return i < j ? model_.hessian[j][i] : model_.hessian[i][j];
  }

  void FindStep() {
    double x[kMaxArmJoints];
    for (int r = 0; r < free_count_; ++r) {
      x[r] = -model_.slope[order_[r]];
      for (int k = 0; k < r; ++k) x[r] -= factor_[r][k] * x[k];
    }
    for (int r = free_count_ - 1; r >= 0; --r) {
      x[r] /= pivots_[r];
      for (int k = r + 1; k < free_count_; ++k) x[r] -= factor_[k][r] * x[k];
      step_[order_[r]] = x[r];
    }
  }

  // By how much the model says that `step_` lowers the energy.
  double Promise() const {
    double gain = 0;
    for (int r = 0; r < free_count_; ++r) {
      const int i = order_[r];
      double pull = 0.5 * model_.hessian[i][i] * step_[i];
      for (int c = 0; c < r; ++c) {
        pull += model_.hessian[i][order_[c]] * step_[order_[c]];
      }
      gain -= step_[i] * (model_.slope[i] + pull);
    }
    return gain;
  }

  // Off a saddle: along directions of negative curvature, the way and as far as
  // leads down most. Joints at their bounds are asked last: where hardly
  // anything pushes them outwards, inwards may lead down all the same. False
  // where nothing does.
  bool Slip(double reach, ArmErrors& errors) {
    const double shift = kLeastShift * mean_;
    const double energy = errors.energy;
    int count = 0;
    for (int r = 0; r < n_; ++r) {
      const int i = order_[r];
      if (settings_.lower[i] == settings_.upper[i]) continue;
      order_[count] = i;
      FactorizeRow(count, shift);
      if (HasFirmPivot(count, shift)) {
        ++count;
        continue;
      }
      // L^T x = the unit vector of this row: x^T H x is its pivot.
      double x[kMaxArmJoints] = {};
      x[count] = 1;
      for (int c = count - 1; c >= 0; --c) {
        for (int k = c + 1; k <= count; ++k) x[c] -= factor_[k][c] * x[k];
      }
      Follow(x, count + 1, reach, errors);
      if (errors.energy < (1 - kLeastGain) * energy) return true;
      // Without it.
    }
    return false;
  }

  // To the best pose along x, the first `count` of order_, either way.
  void Follow(const double* x, int count, double reach, ArmErrors& errors) {
    double largest = 0;
    for (int r = 0; r < count; ++r) largest = Max(largest, Abs(x[r]));
    const ArmRow before = pose_.q;
    ArmRow best = before;
    bool found = false;
    for (double length = reach; length > kLeastSlip; length *= 0.5) {
      bool better = false;
      for (int side = 0; side < 2; ++side) {
        const double way = (side == 0 ? length : -length) / largest;
        for (int r = 0; r < count; ++r) {
          const int i = order_[r];
          pose_.q[i] = Min(Max(before[i] + way * x[r], settings_.lower[i]),
                           settings_.upper[i]);
        }
        const ArmErrors here = Look();
        if (!(here.energy < errors.energy)) continue;
        errors = here;
        best = pose_.q;
        better = true;
      }
      if (found && !better) break;
      found |= better;
    }
    pose_.q = best;
    errors = Look();
  }

  const ArmLayout& arm_;
  const ArmSettings& settings_;
  const int n_;
  const QuadFrame wanted_;
  ArmPose<kWidth> pose_;
  ArmCurvature model_;
  double mean_ = 1;
  int free_count_ = 0;
  int order_[kMaxArmJoints];  // free joints, then those that are blocked
  double factor_[kMaxArmJoints][kMaxArmJoints];
  double pivots_[kMaxArmJoints];
  double step_[kMaxArmJoints];
};

}  // namespace

ArmAttempt SettleArm(const ArmLayout& arm, const ArmSettings& settings,
                     double max_step, const ArmTarget& target, ArmRow& q) {
  Settling settling(arm, settings, target, q);
  const ArmAttempt attempt = settling.Run(max_step);
  q = settling.q();
  return attempt;
}

}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL
