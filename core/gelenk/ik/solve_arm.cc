#include "gelenk/ik/solve_arm.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gelenk/ik/start_sampler.h"

namespace gelenk {
namespace {

using kernel::ArmAttempt;
using kernel::ArmRow;
using kernel::AttemptEnd;

// Around a warm start: this far from it, rad or m, in so many poses. Two rounds
// of the widest vectors; of 300,000 targets that were near their starts all
// that a descent had missed were met so.
constexpr double kNearby = 0.15;
constexpr int kNearbyStarts = 16;

// Longest steps of Newton's method, rad or m: where it looks for the closest
// pose, and where it is to stay in the valley of the start.
constexpr double kLongStep = 0.5;
constexpr double kShortStep = 0.1;

// Iterations of the last attempt against those of the others.
constexpr int kPolishFactor = 4;

// Energies that differ by less, relatively, are as good.
constexpr double kSameEnergy = 1e-6;

// A warm descent that took so many iterations to move a joint so far may have
// started in a singular pose: others take three, rad or m.
constexpr int kForkIterations = 5;
constexpr double kForkMove = 0.01;
// Nearer to a limit than this an arm has little room, rad or m.
constexpr double kNarrow = 1;
// The square of how much longer the other way from a singular pose may be, and
// how much more energy may be left where neither gets there in a frame.
constexpr double kAsShort = 2;
constexpr double kAsClose = 2;

bool Converged(const ArmAttempt& attempt) {
  return attempt.end == AttemptEnd::kConverged;
}

bool IsFork(const ArmRequest& request, const ArmAttempt& attempt, double move) {
  const bool stopped_short =
      attempt.end == AttemptEnd::kStationary && attempt.pushed_at_limit;
  return request.start == SolveStart::kWarm && move > kForkMove &&
         attempt.iterations >= kForkIterations &&
         (Converged(attempt) || stopped_short);
}

class ArmSolve {
 public:
  ArmSolve(const kernel::ArmKernel& kernel, const ArmRequest& request,
           const kernel::ArmTarget& target, const ArmRow& start)
      : kernel_(kernel),
        request_(request),
        layout_(request.arm.layout()),
        settings_(request.settings),
        target_(target),
        start_(start),
        q_(start) {}

  // All but a descent that converged nearby; it is `first`, to q_.
  ArmAttempt GoOn(const ArmAttempt& first, ArmRow& q) {
    best_ = first;
    q_ = q;
    const bool warm = request_.start == SolveStart::kWarm;
    if (best_.end == AttemptEnd::kImpatient && warm) LookAround();
    if (!Converged(best_) && best_.end != AttemptEnd::kStopped &&
        request_.restart_budget > 0) {
      Search();
    }
    // Else the iterations were used up.
    if (best_.end == AttemptEnd::kImpatient) FindClosest();
    if (IsFork(request_, best_, LargestMove(request_.arm, start_, q_))) {
      LeaveRoom();
    }
    const bool settled =
        Converged(best_) || best_.end == AttemptEnd::kStationary;
    if (warm && settled && LargestMove(request_.arm, start_, q_) > kArmJump) {
      StayNear();
    }
    q = q_;
    return best_;
  }

 private:
  void LookAround() {
    if (request_.arm.IsOutOfReach(settings_, target_)) return;
    kernel::ArmStarts starts = {};
    for (int i = 0; i < layout_.joint_count; ++i) {
      starts.lower[i] = std::max(settings_.lower[i], start_[i] - kNearby);
      starts.upper[i] = std::min(settings_.upper[i], start_[i] + kNearby);
    }
    starts.state = static_cast<uint64_t>(request_.restart_seed);
    starts.budget = kNearbyStarts;
    ArmRow q = start_;
    ArmAttempt attempt = kernel_.search(layout_, settings_, starts, target_, q);
    // They are no restarts: none leaves the neighbourhood.
    attempt.drawn = 0;
    Count(attempt);
    // Of poses that do not reach it that of the descent is the one that moves
    // on smoothly from frame to frame.
    if (Converged(attempt)) Replace(attempt, q);
    if (attempt.end == AttemptEnd::kStopped) best_.end = attempt.end;
  }

  void Search() {
    ArmRow q = start_;
    const ArmAttempt attempt = kernel_.search(
        layout_, settings_, RandomStarts(request_, start_), target_, q);
    Count(attempt);
    if (Converged(attempt) || attempt.errors.energy < best_.errors.energy) {
      Replace(attempt, q);
    }
    best_.end = attempt.end;
  }

  // Off a singular pose the arm may bend either way, and rounding decides. Of
  // two ways that are as short the one that runs into a limit is for later
  // frames a dead end.
  void LeaveRoom() {
    const double room = LeastRoom(q_);
    if (room > kNarrow) return;
    ArmRow q = start_;
    for (int i = 0; i < layout_.joint_count; ++i) {
      q[i] = std::clamp(2 * start_[i] - q_[i], settings_.lower[i],
                        settings_.upper[i]);
    }
    ArmAttempt attempt = kernel_.descend(layout_, settings_, target_, q);
    Count(attempt);
    if (!Converged(attempt) && !Converged(best_)) {
      attempt = kernel_.settle(layout_, settings_, kLongStep, target_, q);
      Count(attempt);
    }
    const bool as_close =
        Converged(attempt) ||
        attempt.errors.energy <= kAsClose * best_.errors.energy;
    if (as_close && IsOpposite(q) && LeastRoom(q) > room) Replace(attempt, q);
  }

  // Of `q` to a limit, rad or m.
  double LeastRoom(const ArmRow& q) const {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < layout_.joint_count; ++i) {
      least = std::min({least, q[i] - request_.lower_limits[i],
                        request_.upper_limits[i] - q[i]});
    }
    return least;
  }

  // Whether `q` is on the other side of the start than q_, and as near.
  bool IsOpposite(const ArmRow& q) const {
    double across = 0, way2 = 0, other2 = 0;
    for (int i = 0; i < layout_.joint_count; ++i) {
      const double way = q_[i] - start_[i];
      const double other = q[i] - start_[i];
      across += way * other;
      way2 += way * way;
      other2 += other * other;
    }
    return across < -0.5 * way2 && other2 < kAsShort * way2;
  }

  void FindClosest() {
    kernel::ArmSettings settings = settings_;
    if (request_.restart_budget > 0) settings.max_iterations *= kPolishFactor;
    ArmRow q = q_;
    const ArmAttempt attempt =
        kernel_.settle(layout_, settings, kLongStep, target_, q);
    Count(attempt);
    Replace(attempt, q);
  }

  void StayNear() {
    ArmRow q = start_;
    const ArmAttempt attempt =
        kernel_.settle(layout_, settings_, kShortStep, target_, q);
    Count(attempt);
    if (Converged(attempt) != Converged(best_)) {
      if (Converged(attempt)) Replace(attempt, q);
      return;
    }
    const bool as_close =
        Converged(attempt) ||
        attempt.errors.energy <= (1 + kSameEnergy) * best_.errors.energy;
    if (as_close && LargestMove(request_.arm, start_, q) <
                        LargestMove(request_.arm, start_, q_)) {
      Replace(attempt, q);
    }
  }

  void Count(const ArmAttempt& attempt) {
    best_.iterations += attempt.iterations;
    best_.drawn += attempt.drawn;
  }

  void Replace(const ArmAttempt& attempt, const ArmRow& q) {
    best_.end = attempt.end;
    best_.errors = attempt.errors;
    best_.pushed_at_limit = attempt.pushed_at_limit;
    q_ = q;
  }

  const kernel::ArmKernel& kernel_;
  const ArmRequest& request_;
  const kernel::ArmLayout& layout_;
  const kernel::ArmSettings& settings_;
  const kernel::ArmTarget& target_;
  const ArmRow start_;
  ArmRow q_;
  ArmAttempt best_ = {};
};

}  // namespace

kernel::ArmKernel ArmKernelFor(InstructionSet level) {
#ifdef GELENK_X86_LEVELS
  if (level == InstructionSet::kAvx2) {
    return {kernel::avx2::DescendArm, kernel::avx2::SettleArm,
            kernel::avx2::SearchArm, kernel::avx2::DescendArms};
  }
  if (level == InstructionSet::kAvx512) {
    return {kernel::avx512::DescendArm, kernel::avx512::SettleArm,
            kernel::avx512::SearchArm, kernel::avx512::DescendArms};
  }
#endif
  return {kernel::baseline::DescendArm, kernel::baseline::SettleArm,
          kernel::baseline::SearchArm, kernel::baseline::DescendArms};
}

kernel::ArmStarts RandomStarts(const ArmRequest& request, const ArmRow& q) {
  kernel::ArmStarts starts = {};
  for (int i = 0; i < request.arm.joint_count(); ++i) {
    const StartRange range =
        RangeOfStarts(request.arm.turns(i), q[i], request.settings.lower[i],
                      request.settings.upper[i]);
    starts.lower[i] = range.lower;
    starts.upper[i] = range.upper;
  }
  starts.state = static_cast<uint64_t>(request.restart_seed);
  starts.budget = request.restart_budget;
  return starts;
}

double LargestMove(const SerialArm& arm, const ArmRow& from, const ArmRow& to) {
  double largest = 0;
  for (int i = 0; i < arm.joint_count(); ++i) {
    largest = std::max(largest, std::abs(to[i] - from[i]));
  }
  return largest;
}

kernel::ArmAttempt SolveArm(const kernel::ArmKernel& kernel,
                            const ArmRequest& request,
                            const kernel::ArmTarget& target, ArmRow& q) {
  const ArmRow start = q;
  const ArmAttempt attempt =
      kernel.descend(request.arm.layout(), request.settings, target, q);
  if (Converged(attempt)) {
    if (request.start == SolveStart::kCold) return attempt;
    const double move = LargestMove(request.arm, start, q);
    if (move <= kArmJump && !IsFork(request, attempt, move)) return attempt;
  }
  return ArmSolve(kernel, request, target, start).GoOn(attempt, q);
}

}  // namespace gelenk
