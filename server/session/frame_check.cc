#include "server/session/frame_check.h"

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk::server {
namespace {

// Normalises the target.
absl::Status CheckUpdate(const IkProblem& problem, GoalUpdate& update) {
  if (update.target) {
    if (absl::Status status =
            problem.CheckTarget(update.goal_index, *update.target);
        !status.ok()) {
      return status;
    }
  } else if (update.goal_index < 0 ||
             update.goal_index >= static_cast<int>(problem.goals().size())) {
    GoalTarget none;
    return problem.CheckTarget(update.goal_index, none);
  }
  return update.weight ? IkProblem::CheckWeight(*update.weight)
                       : absl::OkStatus();
}

}  // namespace

absl::Status CheckFrame(const IkProblem& problem, InputFrame& frame) {
  Violations violations;
  for (size_t i = 0; i < frame.updates.size(); ++i) {
    const absl::Status status = CheckUpdate(problem, frame.updates[i]);
    if (!status.ok()) {
      violations.AddStatus(absl::StrCat("targets[", i, "]"), status);
    }
  }
  if (frame.world_from_skeleton) {
    CheckAndNormalize("world_from_skeleton", *frame.world_from_skeleton,
                      violations);
  }
  return violations.ToStatus();
}

}  // namespace gelenk::server
