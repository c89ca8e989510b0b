#include "gelenk/ik/ik_problem.h"

#include <cmath>
#include <string>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {
namespace {

// The kinds that the solvers know so far.
bool IsSolved(const Skeleton& skeleton, const Goal& goal,
              const EffectorTask& task) {
  return task.frame_count > 0 && IsOnOnePath(skeleton, task) &&
         !std::holds_alternative<PlantGoal>(goal.kind);
}

}  // namespace

absl::StatusOr<IkProblem> IkProblem::Create(
    std::shared_ptr<const Skeleton> skeleton, std::vector<Goal> goals,
    const TreeSource& trees) {
  Violations violations;
  if (goals.size() > kMaxGoals) {
    violations.Add("goals", absl::StrFormat("want at most %d, got %d",
                                            kMaxGoals, goals.size()));
    return violations.ToStatus();
  }
  std::vector<EffectorTask> tasks;
  absl::flat_hash_set<std::string> ids;
  for (size_t i = 0; i < goals.size(); ++i) {
    Goal& goal = goals[i];
    const std::string field = absl::StrCat("goals[", i, "]");
    violations.AddStatus(field, CheckAndNormalize(goal));
    if (!ids.insert(goal.id).second) {
      violations.Add(absl::StrCat(field, ".goal_id"),
                     absl::StrCat("duplicate ", QuotedId(goal.id)));
    }
    const absl::Status on_skeleton = CheckOn(*skeleton, goal);
    violations.AddStatus(field, on_skeleton);
    if (!on_skeleton.ok()) continue;
    tasks.push_back(std::visit(
        [&](const auto& kind) { return TaskOf(*skeleton, kind); }, goal.kind));
  }
  if (!violations.empty()) return violations.ToStatus();
  for (size_t i = 0; i < goals.size(); ++i) {
    const Goal& goal = goals[i];
    if (IsSolved(*skeleton, goal, tasks[i]) &&
        goal.priority == goals[0].priority) {
      continue;
    }
    return absl::UnimplementedError(
        absl::StrCat("goals: no solver yet for ", GoalKindName(goal.kind),
                     " goals of priority ", goal.priority));
  }
  std::shared_ptr<const SparseTree> tree =
      trees ? trees(tasks) : std::make_shared<SparseTree>(*skeleton, tasks);
  return IkProblem(std::move(skeleton), std::move(goals), std::move(tasks),
                   std::move(tree));
}

IkProblem::IkProblem(std::shared_ptr<const Skeleton> skeleton,
                     std::vector<Goal> goals, std::vector<EffectorTask> tasks,
                     std::shared_ptr<const SparseTree> tree)
    : skeleton_(std::move(skeleton)),
      goals_(std::move(goals)),
      tasks_(std::move(tasks)),
      tree_(std::move(tree)),
      targets_(goals_.size()) {
  for (size_t i = 0; i < goals_.size(); ++i) {
    RefreshTarget(static_cast<int>(i));
    RefreshWeights(static_cast<int>(i));
  }
}

absl::Status IkProblem::CheckTarget(int goal_index, GoalTarget& target) const {
  if (goal_index < 0 || goal_index >= static_cast<int>(goals_.size())) {
    Violations violations;
    violations.Add("goal_index",
                   absl::StrFormat("want 0 to %d, got %d",
                                   int(goals_.size()) - 1, goal_index));
    return violations.ToStatus();
  }
  const Goal& goal = goals_[goal_index];
  if (!Fits(goal.kind, target)) {
    Violations violations;
    violations.Add("target",
                   absl::StrCat("does not fit the ", GoalKindName(goal.kind),
                                " goal ", QuotedId(goal.id)));
    return violations.ToStatus();
  }
  if (absl::Status status = CheckAndNormalize(target); !status.ok()) {
    return status;
  }
  if (auto* positions = std::get_if<Eigen::VectorXd>(&target)) {
    return CheckPositions(*skeleton_, *positions);
  }
  return absl::OkStatus();
}

void IkProblem::SetTarget(int goal_index, const GoalTarget& target) {
  Retarget(goals_[goal_index].kind, target);
  RefreshTarget(goal_index);
}

absl::Status IkProblem::CheckWeight(double weight) {
  if (std::isfinite(weight) && weight >= 0) return absl::OkStatus();
  Violations violations;
  violations.Add("weight",
                 absl::StrCat("want a finite number >= 0, got ", weight));
  return violations.ToStatus();
}

void IkProblem::SetWeight(int goal_index, double weight) {
  goals_[goal_index].weight = weight;
  RefreshWeights(goal_index);
}

void IkProblem::RefreshTarget(int goal_index) {
  std::visit([&](const auto& kind) { StoreTarget(kind, targets_[goal_index]); },
             goals_[goal_index].kind);
}

void IkProblem::RefreshWeights(int goal_index) {
  const Goal& goal = goals_[goal_index];
  kernel::TaskTarget& target = targets_[goal_index];
  std::visit([&](const auto& kind) { StoreRows(kind, goal.weight, target); },
             goal.kind);
  target.active = goal.weight > 0;
}

const SerialArm* IkProblem::arm() const {
  const SerialArm* arm = tree_->arm();
  if (arm == nullptr || targets_.size() != 1) return nullptr;
  const kernel::TaskTarget& target = targets_[0];
  const double* scale = target.row_scale;
  const bool is_known = target.active && IsSolved(goals_[0]) &&
                        scale[3] == scale[4] && scale[3] == scale[5];
  return is_known ? arm : nullptr;
}

size_t IkProblem::ByteSize() const {
  size_t bytes = sizeof(*this) +
                 targets_.capacity() * sizeof(kernel::TaskTarget) +
                 tasks_.capacity() * sizeof(EffectorTask) +
                 goals_.capacity() * sizeof(Goal);
  for (const Goal& goal : goals_) {
    bytes += goal.id.capacity() + EffectorId(goal.kind).size();
    if (const auto* posture = std::get_if<PostureGoal>(&goal.kind)) {
      bytes += sizeof(double) *
               (posture->positions.size() + posture->joint_weights.capacity());
    }
  }
  return bytes;
}

}  // namespace gelenk
