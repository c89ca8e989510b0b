// How a solve of an arm goes about: which kernel, from where, and which of two
// answers is the better one.
//
// A descent from the start settles all but one in a thousand warm solves and
// most cold ones. What it leaves:
// * A cold solve, or one with restarts, goes on to random starts.
// * A warm one looks around its start: a target nearby is met from a pose
//   nearby, unless the descent ran into a singularity, a bound or the wrong
//   valley.
// * Where nothing converges, Newton's method finds the closest pose.
// * A warm solve that moved a joint far is done again with short steps, and the
//   nearer of two answers stays.
#ifndef GELENK_IK_SOLVE_ARM_H_
#define GELENK_IK_SOLVE_ARM_H_

#include <cstdint>

#include "absl/types/span.h"
#include "gelenk/ik/instruction_set.h"
#include "gelenk/ik/kernel/arm_layout.h"
#include "gelenk/ik/serial_arm.h"
#include "gelenk/ik/solver_options.h"

namespace gelenk {

// A warm answer that moves a joint by more, rad or m, is looked into.
inline constexpr double kArmJump = 0.5;

// Attempts from other starts that a cold solve of an arm has unless told
// otherwise. They go side by side in vector lanes, so that more of them fit
// into the same time. The hardest targets of random arms take some 300.
inline constexpr int kArmColdRestarts = 400;

inline int ArmRestartBudget(const SolverOptions& options, SolveStart start) {
  return options.max_restarts.value_or(
      start == SolveStart::kCold ? kArmColdRestarts : 0);
}

// The kernels of a level.
kernel::ArmKernel ArmKernelFor(InstructionSet level);

struct ArmRequest {
  const SerialArm& arm;
  // Within the bounds of the frame.
  const kernel::ArmSettings& settings;
  // Of the joints, one each.
  absl::Span<const double> lower_limits;
  absl::Span<const double> upper_limits;
  SolveStart start;
  int restart_budget;
  int64_t restart_seed;
};

// Where the random starts of `request` come from, `q` being the given one.
kernel::ArmStarts RandomStarts(const ArmRequest& request,
                               const kernel::ArmRow& q);

// How far the joint that moved most did.
double LargestMove(const SerialArm& arm, const kernel::ArmRow& from,
                   const kernel::ArmRow& to);

// Moves `q`, inside the bounds of the settings, to the solution or to the
// closest pose found. The end is never kImpatient.
kernel::ArmAttempt SolveArm(const kernel::ArmKernel& kernel,
                            const ArmRequest& request,
                            const kernel::ArmTarget& target, kernel::ArmRow& q);

}  // namespace gelenk

#endif  // GELENK_IK_SOLVE_ARM_H_
