// Brings one priority level as near to what it wants as the levels above leave
// it, step by step.
//
// A step is that of LevelStep, damped as LevenbergMarquardtSolver damps its
// own. It leaves the levels above as they are to first order only, so it is
// followed by corrections, until these hold again to kHeldTolerance; a step
// that cannot be corrected, or after which this level is no nearer, is taken
// back and made shorter by stronger damping. So at no time are the levels above
// given up for this one.
//
// Where a level above is out of reach its closest pose is a singular one (an
// arm at full stretch): its Jacobian no longer says which ways lead away from
// it. Steps along these cannot be corrected and are shortened until they are
// harmless, so this level comes nearer only slowly there.
//
// Deterministic. Keeps its memory. Not thread-safe.
#ifndef GELENK_IK_LEVEL_DESCENT_H_
#define GELENK_IK_LEVEL_DESCENT_H_

#include <Eigen/Core>
#include <vector>

#include "gelenk/ik/goal_levels.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/level_step.h"
#include "gelenk/ik/step_space.h"
#include "gelenk/ik/stop_condition.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

// By how much a lower level may move what a higher one got to, m or rad, and
// what is left of that when a step is done.
inline constexpr double kHeldTolerance = 1e-8;

struct LevelSettings {
  double position_tolerance_m;
  double rotation_tolerance_rad;
  int max_iterations;
  // A frame that may go only so far: it is not the last one, and ends sooner.
  bool bounded;
  // As in kernel::Settings.
  bool impatient;
  StopCondition stop;
};

class LevelDescent {
 public:
  // Makes room for whatever a solve of `problem` may need.
  void SetProblem(const IkProblem& problem, const GoalLevels& goals,
                  const StepSpace& space);

  // Moves `positions`, which is inside `space`'s limits and where the levels
  // above `level` hold. `goals` is left there.
  kernel::Attempt Run(GoalLevels& goals, int level,
                      const LevelSettings& settings, StepSpace& space,
                      VectorView positions);

 private:
  void Linearize(GoalLevels& goals, int level, StepSpace& space,
                 const ConstVectorView& positions);
  void Damp(const GoalLevels& goals, int level, double factor,
            double goal_energy, const StepSpace& space,
            const ConstVectorView& positions);
  // Brings the levels above back to what they hold.
  bool Restore(GoalLevels& goals, int level, const StepSpace& space,
               VectorView positions);
  bool RestoreAnew(GoalLevels& goals, int level, const StepSpace& space,
                   VectorView positions);

  std::vector<double> stiffness_;  // by velocity
  LevelStep step_;
  LevelStep restoring_step_;
  StepSpace restoring_space_;
  std::vector<double> trial_;  // positions
  std::vector<double> damping_;
  std::vector<double> correction_;
  std::vector<double> deviations_;
};

}  // namespace gelenk

#endif  // GELENK_IK_LEVEL_DESCENT_H_
