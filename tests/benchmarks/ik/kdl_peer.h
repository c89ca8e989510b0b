// The solvers of Orocos KDL behind the same door as ours.
#ifndef TESTS_BENCHMARKS_IK_KDL_PEER_H_
#define TESTS_BENCHMARKS_IK_KDL_PEER_H_

#include "client/cli/bench/ik_run.h"
#include "client/cli/bench/ik_set.h"

namespace gelenk::benchmarks {

// Newton-Raphson with joint limits, 100 iterations at most. `set` has one pose
// goal on a serial chain of revolute and prismatic joints, and outlives it.
cli::SolveProblem KdlNewtonWithLimits(const cli::IkSet& set, double tolerance);

// Levenberg-Marquardt, which knows no limits.
cli::SolveProblem KdlLevenbergMarquardt(const cli::IkSet& set,
                                        double tolerance);

}  // namespace gelenk::benchmarks

#endif  // TESTS_BENCHMARKS_IK_KDL_PEER_H_
