// What goes into the kernels and what comes out: between the terms of the field
// and plain numbers.
#ifndef GELENK_IK_KERNEL_EXCHANGE_H_
#define GELENK_IK_KERNEL_EXCHANGE_H_

#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/solve_report.h"
#include "gelenk/ik/solver_options.h"
#include "gelenk/ik/stop_condition.h"

namespace gelenk {

// Patient, with the bounds of the skeleton.
kernel::Settings SettingsFor(const IkProblem& problem,
                             const kernel::TreeLayout& tree,
                             const SolverOptions& options,
                             const StopCondition& stop);

// `pushed_at_limit` as in kernel::Attempt.
SolveOutcome OutcomeOf(kernel::AttemptEnd end, bool pushed_at_limit);

// The angle, rad, whose 2 sin(angle / 2) squared is `chord2`.
double AngleOf(double chord2);

}  // namespace gelenk

#endif  // GELENK_IK_KERNEL_EXCHANGE_H_
