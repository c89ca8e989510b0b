#include "gelenk/ik/ik_problem.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/number_check.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/goal_list_check.h"
#include "gelenk/ik/goals/frame_rows.h"
#include "gelenk/ik/goals/pose_rows.h"
#include "gelenk/ik/posture_terms.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {
namespace {

// Whether it is for the sparse tree.
bool IsSparse(const Skeleton& skeleton, const Goal& goal,
              const EffectorTask& task) {
  return IsOnOnePath(skeleton, task) &&
         !std::holds_alternative<CenterOfMassGoal>(goal.kind);
}

bool HasPosture(absl::Span<const Goal> goals) {
  return std::any_of(goals.begin(), goals.end(), [](const Goal& goal) {
    return std::holds_alternative<PostureGoal>(goal.kind);
  });
}

// What a plant holds.
void StorePose(const RigidTransform& world_pose, kernel::TaskTarget& target) {
  Store(world_pose.translation, target.world_translation);
  StoreRotation(world_pose.rotation.normalized(), target);
}

}  // namespace

RigidTransform WorldFromEffector(const IkProblem& problem,
                                 absl::string_view effector_id,
                                 const ConstVectorView& positions) {
  const Skeleton& skeleton = problem.skeleton();
  const EffectorFrame effector = *skeleton.FindEffector(effector_id);
  RigidTransform skeleton_from_effector = effector.joint_from_effector;
  for (int j = effector.joint; j >= 0; j = skeleton.span(j).parent) {
    skeleton_from_effector = skeleton.joint(j).parent_from_joint *
                             JointMotion(skeleton, j, positions) *
                             skeleton_from_effector;
  }
  return problem.world_from_skeleton() * skeleton_from_effector;
}

absl::StatusOr<IkProblem> IkProblem::Create(
    std::shared_ptr<const Skeleton> skeleton, std::vector<Goal> goals,
    const TreeSource& trees) {
  Violations violations;
  GoalListCheck check(skeleton.get(), violations);
  if (!check.AddCount(goals.size())) return violations.ToStatus();
  std::vector<EffectorTask> tasks;
  for (Goal& goal : goals) {
    if (!check.Add(goal)) continue;
    tasks.push_back(std::visit(
        [&](const auto& kind) { return TaskOf(*skeleton, kind); }, goal.kind));
  }
  if (!violations.empty()) return violations.ToStatus();
  bool needs_levels = false;
  for (size_t i = 0; i < goals.size(); ++i) {
    needs_levels = needs_levels || !IsSparse(*skeleton, goals[i], tasks[i]) ||
                   goals[i].priority != goals[0].priority;
  }
  std::shared_ptr<const SparseTree> tree =
      trees ? trees(tasks) : std::make_shared<SparseTree>(*skeleton, tasks);
  return IkProblem(std::move(skeleton), std::move(goals), std::move(tree),
                   needs_levels);
}

IkProblem::IkProblem(std::shared_ptr<const Skeleton> skeleton,
                     std::vector<Goal> goals,
                     std::shared_ptr<const SparseTree> tree, bool needs_levels)
    : skeleton_(std::move(skeleton)),
      goals_(std::move(goals)),
      tree_(std::move(tree)),
      needs_levels_(needs_levels),
      targets_(goals_.size()) {
  for (size_t i = 0; i < goals_.size(); ++i) {
    const int goal = static_cast<int>(i);
    RefreshTarget(goal);
    RefreshWeights(goal);
    targets_[i].free = std::holds_alternative<PlantGoal>(goals_[i].kind);
    if (IsFreePlant(goal)) ++free_plant_count_;
  }
  if (!HasPosture(goals_)) return;
  tree_columns_.assign(skeleton_->joint_count(), -1);
  for (int c = tree_->Layout().column_count - 1; c >= 0; --c) {
    tree_columns_[tree_->joint_of_column(c)] = c;
  }
  posture_.reserve(skeleton_->velocity_count());
  RefreshPosture();
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
  if (std::holds_alternative<Eigen::VectorXd>(target)) RefreshPosture();
}

absl::Status IkProblem::CheckWeight(double weight) {
  Violations violations;
  CheckNotNegative("weight", weight, violations);
  return violations.ToStatus();
}

void IkProblem::SetWeight(int goal_index, double weight) {
  const bool was_free = IsFreePlant(goal_index);
  goals_[goal_index].weight = weight;
  RefreshWeights(goal_index);
  const GoalKind& kind = goals_[goal_index].kind;
  if (std::holds_alternative<PostureGoal>(kind)) RefreshPosture();
  if (!std::holds_alternative<PlantGoal>(kind)) return;
  // Switched off it lets go.
  if (weight == 0) targets_[goal_index].free = true;
  free_plant_count_ += int{IsFreePlant(goal_index)} - int{was_free};
}

bool IkProblem::IsFreePlant(int goal_index) const {
  return targets_[goal_index].free && targets_[goal_index].active;
}

void IkProblem::CapturePlants(const ConstVectorView& positions) {
  if (free_plant_count_ == 0) return;
  for (size_t i = 0; i < goals_.size(); ++i) {
    if (!IsFreePlant(static_cast<int>(i))) continue;
    StorePose(WorldFromEffector(*this, EffectorId(goals_[i].kind), positions),
              targets_[i]);
    targets_[i].free = false;
  }
  free_plant_count_ = 0;
}

void IkProblem::CopyTargets(const ConstVectorView& positions,
                            std::vector<kernel::TaskTarget>& targets) const {
  targets.assign(targets_.begin(), targets_.end());
  for (size_t i = 0; i < goals_.size(); ++i) {
    if (!IsFreePlant(static_cast<int>(i))) continue;
    StorePose(WorldFromEffector(*this, EffectorId(goals_[i].kind), positions),
              targets[i]);
  }
}

void IkProblem::KeepPlants(const IkProblem& before) {
  for (size_t i = 0; i < goals_.size(); ++i) {
    if (!IsFreePlant(static_cast<int>(i))) continue;
    for (size_t k = 0; k < before.goals_.size(); ++k) {
      const kernel::TaskTarget& held = before.targets_[k];
      if (before.goals_[k].id != goals_[i].id || !held.active || held.free ||
          EffectorId(before.goals_[k].kind) != EffectorId(goals_[i].kind) ||
          !std::holds_alternative<PlantGoal>(before.goals_[k].kind)) {
        continue;
      }
      std::copy_n(held.world_rotation, 9, targets_[i].world_rotation);
      std::copy_n(held.world_translation, 3, targets_[i].world_translation);
      targets_[i].free = false;
      --free_plant_count_;
    }
  }
}

void IkProblem::RefreshPosture() {
  posture_on_tree_ =
      JoinPostures(*skeleton_, goals_, std::nullopt, tree_columns_, posture_);
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
  const bool is_known = target.active && !has_free_plants() &&
                        scale[3] == scale[4] && scale[3] == scale[5];
  return is_known ? arm : nullptr;
}

size_t IkProblem::ByteSize() const {
  size_t bytes =
      sizeof(*this) + targets_.capacity() * sizeof(kernel::TaskTarget) +
      posture_.capacity() * sizeof(kernel::PostureTerm) +
      tree_columns_.capacity() * sizeof(int) + goals_.capacity() * sizeof(Goal);
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
