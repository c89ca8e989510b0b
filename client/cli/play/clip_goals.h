// What a live actor would send: where hands, feet, head and hips are.
#ifndef CLIENT_CLI_PLAY_CLIP_GOALS_H_
#define CLIENT_CLI_PLAY_CLIP_GOALS_H_

#include <vector>

#include "absl/types/span.h"
#include "gelenk/ik/goal.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/motion/body_parts.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::cli {

// Position goals for hands, feet and head and a pose goal for the hips; for
// what is no body, position goals for the ends of all chains and a pose goal
// for the root. Targets are those of the rest pose.
std::vector<Goal> GoalsFor(const Skeleton& skeleton, const BodyParts& body);

// The targets that `goals` have when the body stands as `world_from_joints`.
// Allocates only when `targets` grows.
void TargetsAt(const Skeleton& skeleton, absl::Span<const Goal> goals,
               const WorldTransforms& world_from_joints,
               std::vector<GoalTarget>& targets);

// Distance of a goal's effector from its target: m, and rad; 0 for what the
// goal does not ask for.
struct GoalError {
  double position_m = 0;
  double rotation_rad = 0;
};
GoalError ErrorOf(const Skeleton& skeleton, const Goal& goal,
                  const GoalTarget& target,
                  const WorldTransforms& world_from_joints);

// Where the effector of `goal` is.
RigidTransform WorldFromEffector(const Skeleton& skeleton, const Goal& goal,
                                 const WorldTransforms& world_from_joints);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PLAY_CLIP_GOALS_H_
