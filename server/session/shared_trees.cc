#include "server/session/shared_trees.h"

#include <algorithm>
#include <utility>

#include "gelenk/base/violations.h"
#include "gelenk/ik/ik_solver.h"

namespace gelenk::server {
namespace {

template <class Number>
void AppendBits(const Number* numbers, size_t count, std::string& bits) {
  bits.append(reinterpret_cast<const char*>(numbers), count * sizeof(Number));
}

std::string BitsOf(absl::Span<const EffectorTask> tasks) {
  std::string bits;
  for (const EffectorTask& task : tasks) {
    AppendBits(&task.shape, 1, bits);
    AppendBits(&task.translation_rows, 1, bits);
    AppendBits(&task.rotation_rows, 1, bits);
    AppendBits(&task.frame_count, 1, bits);
    for (int f = 0; f < task.frame_count; ++f) {
      const RigidTransform& frame = task.frames[f].joint_from_effector;
      AppendBits(&task.frames[f].joint, 1, bits);
      AppendBits(frame.rotation.coeffs().data(), 4, bits);
      AppendBits(frame.translation.data(), 3, bits);
    }
  }
  return bits;
}

}  // namespace

SharedTrees::SharedTrees(std::shared_ptr<const Skeleton> skeleton)
    : skeleton_(std::move(skeleton)) {}

absl::StatusOr<IkProblem> SharedTrees::CreateProblem(
    std::vector<Goal> goals, const SolverOptions& options) {
  absl::StatusOr<IkProblem> problem = IkProblem::Create(
      skeleton_, std::move(goals),
      [this](absl::Span<const EffectorTask> tasks) { return Find(tasks); });
  if (!problem.ok()) return problem.status();
  Violations violations;
  violations.AddStatus("solver_options", IkSolver::Check(*problem, options));
  if (!violations.empty()) return violations.ToStatus();
  return problem;
}

std::shared_ptr<const SparseTree> SharedTrees::Find(
    absl::Span<const EffectorTask> tasks) {
  std::string key = BitsOf(tasks);
  std::lock_guard<std::mutex> lock(mutex_);
  const auto found = trees_.find(key);
  if (found != trees_.end()) {
    if (std::shared_ptr<const SparseTree> tree = found->second.lock()) {
      return tree;
    }
  }
  std::erase_if(trees_,
                [](const auto& entry) { return entry.second.expired(); });
  // Not make_shared, which would hold the tree's memory as long as trees_ does.
  std::shared_ptr<const SparseTree> tree(new SparseTree(*skeleton_, tasks));
  trees_[std::move(key)] = tree;
  return tree;
}

int SharedTrees::tree_count() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return static_cast<int>(
      std::count_if(trees_.begin(), trees_.end(),
                    [](const auto& entry) { return !entry.second.expired(); }));
}

}  // namespace gelenk::server
