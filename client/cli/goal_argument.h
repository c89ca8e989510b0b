// Goals as people type them: LeftHand=0.4,1.2,0.3
#ifndef CLIENT_CLI_GOAL_ARGUMENT_H_
#define CLIENT_CLI_GOAL_ARGUMENT_H_

#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/ik/goal.h"

namespace gelenk::cli {

// `ID=` and the numbers of the kind: x,y,z m; qx,qy,qz,qw; or both. The id is
// what stands before the last `=`. INVALID_ARGUMENT naming the text.
absl::StatusOr<GoalKind> ParsePositionGoal(absl::string_view argument);
absl::StatusOr<GoalKind> ParseRotationGoal(absl::string_view argument);
absl::StatusOr<GoalKind> ParsePoseGoal(absl::string_view argument);

// Goals called after their end effectors, numbered where one has several.
std::vector<Goal> NameGoals(std::vector<GoalKind> kinds);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_GOAL_ARGUMENT_H_
