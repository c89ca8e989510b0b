#include "gelenk/ik/goals/aim_goal.h"

#include <cmath>

#include "gelenk/ik/goals/direction_rows.h"
#include "gelenk/ik/goals/frame_rows.h"
#include "gelenk/ik/goals/goal_check.h"
#include "gelenk/ik/goals/pose_rows.h"

namespace gelenk {
namespace {

// Nearer than this to the effector's origin a point has no direction to rely
// on, and the goal fades out.
constexpr double kAimBlur_m = 1e-3;

}  // namespace

void CheckAndNormalize(AimGoal& goal, Violations& violations) {
  CheckDirection("axis", goal.axis, violations);
  CheckNumbers("world_point", goal.world_point, violations);
}

void CheckOn(const Skeleton& skeleton, AimGoal& goal, Violations& violations) {
  CheckEffector(skeleton, "end_effector_id", goal.end_effector_id, violations);
}

EffectorTask TaskOf(const Skeleton& skeleton, const AimGoal& goal) {
  return TaskOnEffector(skeleton, goal.end_effector_id, kernel::GoalShape::kAim,
                        0, 2);
}

void StoreTarget(const AimGoal& goal, kernel::TaskTarget& target) {
  Store(goal.world_point, target.world_translation);
  Store(goal.axis, target.direction);
}

void StoreRows(const AimGoal&, double weight, kernel::TaskTarget& target) {
  StoreScales(kernel::GoalShape::kAim, 0, 2, 1, weight, target);
}

void LinearizeAim(const kernel::TaskTarget& target,
                  const kernel::GoalFrame* frames, kernel::GoalRows& rows) {
  const Eigen::Vector3d axis =
      View(frames[0].rotation) * View(target.direction);
  const Eigen::Vector3d way =
      View(target.world_translation) - View(frames[0].translation);
  const double distance2 = way.squaredNorm();
  const double blurred2 = distance2 + kAimBlur_m * kAimBlur_m;
  const double fade = distance2 / blurred2;
  // On the spot any direction will do.
  const Eigen::Vector3d to = distance2 > 0 ? way / std::sqrt(distance2) : axis;
  const DirectionRows turn = TurnInto(axis, to);
  rows.position_error2 = 0;
  rows.rotation_error2 = fade * fade * turn.residual.squaredNorm();
  rows.rotation_energy = AngleEnergy(rows.rotation_error2);
  for (int r = 0; r < 2; ++r) {
    const Eigen::Vector3d about = fade * turn.basis.row(r);
    rows.residual[r] = fade * turn.residual[r];
    AngularRow(rows, 0, r) = about;
    // Moving the effector turns the way to the point by way x v / distance^2.
    VelocityRow(rows, 0, r) = turn.basis.row(r).cross(way) / blurred2;
  }
}

}  // namespace gelenk
