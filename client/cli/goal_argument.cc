#include "client/cli/goal_argument.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/text/number_list.h"
#include "gelenk/formats/unique_names.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk::cli {
namespace {

struct NamedNumbers {
  std::string id;
  std::vector<double> numbers;
};

absl::StatusOr<NamedNumbers> Split(absl::string_view argument,
                                   absl::string_view form, int count) {
  const size_t equals = argument.rfind('=');
  if (equals == absl::string_view::npos || equals == 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("want ", form, ", got \"", argument, "\""));
  }
  absl::StatusOr<std::vector<double>> numbers =
      ParseNumbers(argument.substr(equals + 1), count);
  if (!numbers.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("want ", form, ": ", numbers.status().message()));
  }
  return NamedNumbers{std::string(argument.substr(0, equals)),
                      *std::move(numbers)};
}

}  // namespace

absl::StatusOr<GoalKind> ParsePositionGoal(absl::string_view argument) {
  const auto parsed = Split(argument, "ID=x,y,z", 3);
  if (!parsed.ok()) return parsed.status();
  PositionGoal goal;
  goal.end_effector_id = parsed->id;
  goal.world_position = Eigen::Vector3d(parsed->numbers.data());
  return goal;
}

absl::StatusOr<GoalKind> ParseRotationGoal(absl::string_view argument) {
  const auto parsed = Split(argument, "ID=qx,qy,qz,qw", 4);
  if (!parsed.ok()) return parsed.status();
  RotationGoal goal;
  goal.end_effector_id = parsed->id;
  goal.world_rotation = QuaternionXyzw(parsed->numbers.data());
  return goal;
}

absl::StatusOr<GoalKind> ParsePoseGoal(absl::string_view argument) {
  const auto parsed = Split(argument, "ID=x,y,z,qx,qy,qz,qw", 7);
  if (!parsed.ok()) return parsed.status();
  PoseGoal goal;
  goal.end_effector_id = parsed->id;
  goal.world_pose.translation = Eigen::Vector3d(parsed->numbers.data());
  goal.world_pose.rotation = QuaternionXyzw(parsed->numbers.data() + 3);
  return goal;
}

std::vector<Goal> NameGoals(std::vector<GoalKind> kinds) {
  UniqueNames names(kMaxIdBytes);
  std::vector<Goal> goals;
  for (GoalKind& kind : kinds) {
    Goal goal;
    goal.id = names.Take(EffectorId(kind));
    goal.kind = std::move(kind);
    goals.push_back(std::move(goal));
  }
  return goals;
}

}  // namespace gelenk::cli
