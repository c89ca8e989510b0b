#include "gelenk/ik/kernel_exchange.h"

#include <algorithm>
#include <cmath>

namespace gelenk {

kernel::Settings SettingsFor(const IkProblem& problem,
                             const kernel::TreeLayout& tree,
                             const SolverOptions& options,
                             const StopCondition& stop) {
  kernel::Settings settings = {};
  const RigidTransform& base = problem.world_from_skeleton();
  const Eigen::Matrix3d rotation = base.rotation.toRotationMatrix();
  for (int i = 0; i < 9; ++i) {
    settings.base_rotation[i] = rotation(i / 3, i % 3);
  }
  for (int i = 0; i < 3; ++i)
    settings.base_translation[i] = base.translation[i];
  const double chord =
      2 * std::sin(0.5 * std::min(options.rotation_tolerance_rad, M_PI));
  settings.position_tolerance2 =
      options.position_tolerance_m * options.position_tolerance_m;
  settings.rotation_tolerance2 = chord * chord;
  settings.posture = problem.posture().data();
  settings.posture_count = static_cast<int>(problem.posture().size());
  settings.lower = tree.lower;
  settings.upper = tree.upper;
  settings.max_iterations = options.max_iterations;
  settings.stop = stop.function;
  settings.stop_context = stop.context;
  return settings;
}

SolveOutcome OutcomeOf(kernel::AttemptEnd end, bool pushed_at_limit) {
  switch (end) {
    case kernel::AttemptEnd::kConverged:
      return SolveOutcome::kConverged;
    case kernel::AttemptEnd::kStationary:
      return pushed_at_limit ? SolveOutcome::kStalledAtLimits
                             : SolveOutcome::kUnreachable;
    case kernel::AttemptEnd::kStopped:
      return SolveOutcome::kTimeLimit;
    default:
      return SolveOutcome::kIterationLimit;
  }
}

double AngleOf(double chord2) {
  const double half_chord = 0.5 * std::sqrt(chord2);
  // To the last digit, without the library's call.
  if (half_chord < 1e-4) {
    return 2 * half_chord * (1 + half_chord * half_chord / 6);
  }
  return 2 * std::asin(std::min(half_chord, 1.0));
}

}  // namespace gelenk
