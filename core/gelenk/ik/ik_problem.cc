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
bool IsSolved(const Goal& goal) {
  const GoalKind& kind = goal.kind;
  if (const auto* rotation = std::get_if<RotationGoal>(&kind)) {
    return rotation->axes.count() == 3;
  }
  if (const auto* pose = std::get_if<PoseGoal>(&kind)) {
    return pose->rotation_axes.count() == 3;
  }
  return std::holds_alternative<PositionGoal>(kind);
}

bool HasTranslation(const GoalKind& kind) {
  return !std::holds_alternative<RotationGoal>(kind);
}

bool HasRotation(const GoalKind& kind) {
  return !std::holds_alternative<PositionGoal>(kind);
}

AxisMask AxesOf(const GoalKind& kind) {
  if (const auto* position = std::get_if<PositionGoal>(&kind)) {
    return position->axes;
  }
  if (const auto* pose = std::get_if<PoseGoal>(&kind)) return pose->axes;
  return {};
}

void StoreRotation(const Eigen::Quaterniond& rotation,
                   kernel::TaskTarget& target) {
  const Eigen::Matrix3d m = rotation.toRotationMatrix();
  for (int i = 0; i < 9; ++i) target.world_rotation[i] = m(i / 3, i % 3);
}

void StoreTranslation(const Eigen::Vector3d& translation,
                      kernel::TaskTarget& target) {
  for (int i = 0; i < 3; ++i) target.world_translation[i] = translation[i];
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
    if (!on_skeleton.ok() || !IsSolved(goal)) continue;
    tasks.push_back({*skeleton->FindEffector(EffectorId(goal.kind)),
                     HasTranslation(goal.kind), HasRotation(goal.kind)});
  }
  if (!violations.empty()) return violations.ToStatus();
  for (const Goal& goal : goals) {
    if (IsSolved(goal) && goal.priority == goals[0].priority) continue;
    return absl::UnimplementedError(
        absl::StrCat("goals: no solver yet for ", GoalKindName(goal.kind),
                     " goals of priority ", goal.priority));
  }
  std::shared_ptr<const SparseTree> tree =
      trees ? trees(tasks) : std::make_shared<SparseTree>(*skeleton, tasks);
  return IkProblem(std::move(skeleton), std::move(goals), std::move(tree));
}

IkProblem::IkProblem(std::shared_ptr<const Skeleton> skeleton,
                     std::vector<Goal> goals,
                     std::shared_ptr<const SparseTree> tree)
    : skeleton_(std::move(skeleton)),
      goals_(std::move(goals)),
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
  const Goal& goal = goals_[goal_index];
  kernel::TaskTarget& target = targets_[goal_index];
  if (const auto* position = std::get_if<PositionGoal>(&goal.kind)) {
    StoreTranslation(position->world_position, target);
  } else if (const auto* rotation = std::get_if<RotationGoal>(&goal.kind)) {
    StoreRotation(rotation->world_rotation, target);
  } else if (const auto* pose = std::get_if<PoseGoal>(&goal.kind)) {
    StoreTranslation(pose->world_pose.translation, target);
    StoreRotation(pose->world_pose.rotation, target);
  }
}

void IkProblem::RefreshWeights(int goal_index) {
  const Goal& goal = goals_[goal_index];
  kernel::TaskTarget& target = targets_[goal_index];
  target.active = goal.weight > 0;
  const AxisMask axes = AxesOf(goal.kind);
  const double counts[3] = {axes.x ? 1.0 : 0.0, axes.y ? 1.0 : 0.0,
                            axes.z ? 1.0 : 0.0};
  const PoseGoal* pose = std::get_if<PoseGoal>(&goal.kind);
  const double rotation_scale = pose ? pose->rotation_scale_m_per_rad : 1;
  const double root = std::sqrt(goal.weight);
  for (int k = 0; k < 3; ++k) {
    target.row_counts[k] = counts[k];
    target.row_scale[k] = root * counts[k];
    target.row_scale[3 + k] = root * rotation_scale;
  }
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
