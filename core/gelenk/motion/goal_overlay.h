// Goals on top of clips: forward and inverse kinematics together.
//
// Each pose that comes in (what clips do) is solved from, for the goals at
// their weights of that time; the rest of the body stays as near to that pose
// as the goals allow, by a posture goal on a priority below all others.
//
// A goal's weight is 0 where the clips have their way and 1 where the goal has
// its own. In between, a goal on an effector's position, rotation or pose has
// its target on the way from where the clips have the effector to where the
// goal wants it, so that it neither pops nor depends on what else is solved
// for; the weight of any other goal is multiplied. Poses do not depend on the
// ones before, but that plants hold what they found when they were switched on.
#ifndef GELENK_MOTION_GOAL_OVERLAY_H_
#define GELENK_MOTION_GOAL_OVERLAY_H_

#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/ik/goal.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/ik_solver.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/motion/weight_curve.h"

namespace gelenk {

// Where a target is at one time, world frame.
struct TargetKey {
  double time_s = 0;
  // Of a position goal the translation counts, of a rotation goal the rotation.
  RigidTransform world_pose;
};

struct TimedGoal {
  // Its target is that at all times where `targets` is empty.
  Goal goal;
  // In [0, 1].
  WeightCurve weight = 1;
  // Straight lines between keys, the shorter turn; the first and the last hold
  // before and after. Of position, rotation and pose goals.
  std::vector<TargetKey> targets = {};
};

// Goals have priorities up to this; the clips' pose is on the next one.
inline constexpr int kMaxOverlayPriority = kMaxPriorities - 2;

class GoalOverlay {
 public:
  // INVALID_ARGUMENT listing what is wrong, as "goals[1].weight[0].weight:
  // ...": goals as IkProblem::Create and IkSolver::Check say, posture goals,
  // priorities, weights, targets.
  static absl::StatusOr<GoalOverlay> Create(
      std::shared_ptr<const Skeleton> skeleton, std::vector<TimedGoal> goals,
      const SolverOptions& options,
      const RigidTransform& world_from_skeleton = RigidTransform());

  // Moves `positions`, a whole pose, from what clips do at `time_s`. The report
  // has an error per goal, from where its weight puts its target. Without a
  // goal that is on nothing happens. Allocates nothing beyond what
  // IkSolver::Solve does.
  void Apply(double time_s, IkSolver& solver, VectorView positions,
             SolveReport& report);

  ReportDetail detail() const { return options_.detail; }

 private:
  struct Track {
    WeightCurve weight;
    double full_weight;
    std::vector<TargetKey> targets;
    // Of goals on an effector's position, rotation or pose.
    std::optional<EffectorFrame> effector;
    GoalTarget own_target;
  };

  GoalOverlay(IkProblem problem, const SolverOptions& options)
      : problem_(std::move(problem)), options_(options) {}

  // Where the effector of `track` is in `frames_`.
  RigidTransform WorldPoseOf(const Track& track) const;
  GoalTarget TargetAt(const Track& track, double time_s, double weight) const;

  IkProblem problem_;
  SolverOptions options_;
  std::vector<Track> tracks_;
  WorldTransforms frames_;
  GoalTarget posture_;
};

}  // namespace gelenk

#endif  // GELENK_MOTION_GOAL_OVERLAY_H_
