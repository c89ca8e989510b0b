// Descents of an arm side by side, one a lane of vector registers: from many
// starts to one target, or each to a target of its own. Compiled once per level
// of the instruction set (see base/kernel/lanes.h).
//
// All lanes of a solve do the same arithmetic, so that an answer does not
// depend on the lane, nor on what its neighbours are about.
#include "gelenk/ik/kernel/arm_lanes.h"
#include "gelenk/ik/kernel/arm_layout.h"
#include "gelenk/ik/kernel/arm_policy.h"
#include "gelenk/ik/kernel/split_mix.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

constexpr int kLanes = GELENK_KERNEL_LANES;
using Vector = Lanes<kLanes>;
using Pack = Vector::Pack;
using Mask = Vector::Mask;

// Gives up descents as arm_descent.cc does.
class Patience {
 public:
  explicit Patience(int max_iterations) : max_iterations_(max_iterations) {}

  GELENK_INLINE void Begin(int lane) {
    age_[lane] = 0;
    due_[lane] = 0;
    window_energy_[lane] = __builtin_inf();
  }

  // Iterations since Begin; right before GivenUp of the next one.
  int age(int lane) const { return static_cast<int>(age_[lane]); }

  // The lanes of such descents; to be called once an iteration.
  GELENK_INLINE unsigned GivenUp(const Pack& energy) {
    const Mask is_due = age_ == due_;
    const Mask slow = is_due & ~(energy <= kArmWindowGain * window_energy_);
    const Mask old = age_ >= double(max_iterations_);
    window_energy_ = Vector::Select(is_due, energy, window_energy_);
    due_ = Vector::Select(is_due, due_ + kArmWindow, due_);
    age_ = age_ + 1.0;
    return Vector::Bits(slow | old);
  }

 private:
  const int max_iterations_;
  Pack age_ = {};
  Pack due_ = {};
  Pack window_energy_ = {};
};

template <int kRows, bool kPlain>
class Crowd {
 public:
  Crowd(const ArmLayout& arm, const ArmSettings& settings)
      : settings_(settings),
        joint_count_(arm.joint_count),
        lanes_(arm, settings),
        patience_(settings.max_iterations) {}

  ArmAttempt Search(const ArmStarts& starts, const ArmTarget& target,
                    ArmRow& q) {
    ArmAttempt attempt = {AttemptEnd::kImpatient, 0, 0, {}, false};
    attempt.errors.energy = __builtin_inf();
    uint64_t state = starts.state;
    unsigned busy = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      lanes_.SetTarget(lane, target);
      // Lanes beyond the budget idle along.
      lanes_.SetPose(lane, q);
      if (attempt.drawn == starts.budget) continue;
      ++attempt.drawn;
      Draw(lane, starts, state);
      busy |= 1u << lane;
    }
    for (;; ++attempt.iterations) {
      lanes_.Look();
      if (const unsigned converged = lanes_.Converged() & busy) {
        attempt.end = AttemptEnd::kConverged;
        Take(__builtin_ctz(converged), attempt, q);
        return attempt;
      }
      unsigned given_up = patience_.GivenUp(lanes_.energy()) & busy;
      for (unsigned left = given_up; left != 0; left &= left - 1) {
        const int lane = __builtin_ctz(left);
        if (lanes_.energy()[lane] < attempt.errors.energy) {
          Take(lane, attempt, q);
        }
      }
      if (IsToStop(settings_)) {
        attempt.end = AttemptEnd::kStopped;
        return attempt;
      }
      lanes_.Step();
      for (; given_up != 0; given_up &= given_up - 1) {
        const int lane = __builtin_ctz(given_up);
        if (attempt.drawn < starts.budget) {
          ++attempt.drawn;
          Draw(lane, starts, state);
        } else {
          busy &= ~(1u << lane);
        }
      }
      if (busy == 0) return attempt;
    }
  }

  void DescendAll(const ArmStarts* starts, const ArmTarget* targets, int count,
                  ArmRow* poses, ArmAttempt* attempts) {
    int next = 0;
    int served[kLanes];  // which target
    uint64_t states[kLanes];
    unsigned busy = 0;
    const auto serve = [&](int lane) {
      if (next == count) {
        busy &= ~(1u << lane);
        return;
      }
      busy |= 1u << lane;
      served[lane] = next;
      if (starts != nullptr) states[lane] = starts->state;
      attempts[next] = {AttemptEnd::kImpatient, 0, 0, {}, false};
      lanes_.SetTarget(lane, targets[next]);
      lanes_.SetPose(lane, poses[next]);
      patience_.Begin(lane);
      ++next;
    };
    for (int lane = 0; lane < kLanes; ++lane) {
      // Lanes without a target idle along with the first.
      lanes_.SetTarget(lane, targets[0]);
      lanes_.SetPose(lane, poses[0]);
      serve(lane);
    }
    while (busy != 0) {
      lanes_.Look();
      const unsigned converged = lanes_.Converged() & busy;
      unsigned done = converged;
      for (unsigned left = converged; left != 0; left &= left - 1) {
        const int lane = __builtin_ctz(left);
        ArmAttempt& attempt = attempts[served[lane]];
        attempt.end = AttemptEnd::kConverged;
        attempt.iterations += patience_.age(lane);
        Take(lane, attempt, poses[served[lane]]);
      }
      const unsigned given_up =
          patience_.GivenUp(lanes_.energy()) & busy & ~converged;
      if (IsToStop(settings_)) {
        for (unsigned left = busy & ~converged; left != 0; left &= left - 1) {
          attempts[served[__builtin_ctz(left)]].end = AttemptEnd::kStopped;
        }
        for (; next < count; ++next) {
          attempts[next] = {AttemptEnd::kStopped, 0, 0, {}, false};
        }
        return;
      }
      lanes_.Step();
      for (unsigned left = given_up; left != 0; left &= left - 1) {
        const int lane = __builtin_ctz(left);
        ArmAttempt& attempt = attempts[served[lane]];
        if (starts == nullptr || attempt.drawn == starts->budget) {
          done |= 1u << lane;
          continue;
        }
        attempt.iterations += patience_.age(lane);
        ++attempt.drawn;
        Draw(lane, *starts, states[lane]);
      }
      for (; done != 0; done &= done - 1) serve(__builtin_ctz(done));
    }
  }

 private:
  void Draw(int lane, const ArmStarts& starts, uint64_t& state) {
    ArmRow q;
    for (int i = 0; i < joint_count_; ++i) {
      q[i] = NextUniform(state, starts.lower[i], starts.upper[i]);
    }
    lanes_.SetPose(lane, q);
    patience_.Begin(lane);
  }

  void Take(int lane, ArmAttempt& attempt, ArmRow& q) {
    attempt.errors = lanes_.errors(lane);
    lanes_.GetPose(lane, q);
  }

  const ArmSettings& settings_;
  const int joint_count_;
  ArmLanes<kLanes, kRows, kPlain> lanes_;
  Patience patience_;
};

}  // namespace

ArmAttempt SearchArm(const ArmLayout& arm, const ArmSettings& settings,
                     const ArmStarts& starts, const ArmTarget& target,
                     ArmRow& q) {
  if (settings.rotation_scale == 0) {
    return Crowd<3, false>(arm, settings).Search(starts, target, q);
  }
  if (arm.is_plain && settings.is_plain) {
    return Crowd<6, true>(arm, settings).Search(starts, target, q);
  }
  return Crowd<6, false>(arm, settings).Search(starts, target, q);
}

void DescendArms(const ArmLayout& arm, const ArmSettings& settings,
                 const ArmStarts* starts, const ArmTarget* targets, int count,
                 ArmRow* poses, ArmAttempt* attempts) {
  if (settings.rotation_scale == 0) {
    Crowd<3, false>(arm, settings)
        .DescendAll(starts, targets, count, poses, attempts);
  } else if (arm.is_plain && settings.is_plain) {
    Crowd<6, true>(arm, settings)
        .DescendAll(starts, targets, count, poses, attempts);
  } else {
    Crowd<6, false>(arm, settings)
        .DescendAll(starts, targets, count, poses, attempts);
  }
}

}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL
