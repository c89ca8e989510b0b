// Goals on one skeleton, ready to be solved: what a session keeps warm.
//
// Values in; the pose stays with the caller. Not thread-safe.
#ifndef GELENK_IK_IK_PROBLEM_H_
#define GELENK_IK_IK_PROBLEM_H_

#include <functional>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/ik/goal.h"
#include "gelenk/ik/sparse_tree.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// A body with trackers everywhere has about 20 goals.
inline constexpr int kMaxGoals = 256;

// Finds or makes the tree for such tasks. Problems of the same skeleton whose
// goals name the same effectors may share one.
using TreeSource = std::function<std::shared_ptr<const SparseTree>(
    absl::Span<const EffectorTask>)>;

class IkProblem {
 public:
  // INVALID_ARGUMENT listing every bad goal: malformed (see CheckAndNormalize),
  // not of this skeleton (see CheckOn), duplicate id, too many. No goals is
  // fine: solving leaves the pose as it is. Without `trees` the problem makes a
  // tree of its own.
  static absl::StatusOr<IkProblem> Create(
      std::shared_ptr<const Skeleton> skeleton, std::vector<Goal> goals,
      const TreeSource& trees = nullptr);

  IkProblem(IkProblem&&) = default;
  IkProblem& operator=(IkProblem&&) = default;

  const Skeleton& skeleton() const { return *skeleton_; }
  const std::shared_ptr<const Skeleton>& shared_skeleton() const {
    return skeleton_;
  }
  absl::Span<const Goal> goals() const { return goals_; }

  // INVALID_ARGUMENT when there is no such goal, `target` does not fit its kind
  // or is malformed. Normalises near-unit quaternions in `target`.
  absl::Status CheckTarget(int goal_index, GoalTarget& target) const;

  // `target` must have passed CheckTarget. Allocates nothing.
  void SetTarget(int goal_index, const GoalTarget& target);

  // Finite and >= 0; INVALID_ARGUMENT otherwise.
  static absl::Status CheckWeight(double weight);
  void SetWeight(int goal_index, double weight);

  const RigidTransform& world_from_skeleton() const {
    return world_from_skeleton_;
  }
  void SetWorldFromSkeleton(const RigidTransform& world_from_skeleton) {
    world_from_skeleton_ = world_from_skeleton;
  }

  // Plants that were switched on and have no pose to hold yet get their
  // effectors' at `positions`. Whoever keeps a problem from solve to solve
  // calls it before each; else plants hold where each solve starts. Cheap when
  // there is none; allocates nothing.
  void CapturePlants(const ConstVectorView& positions);

  // Plants that were on in `before`, by their ids, hold on to the same pose.
  // For a problem that takes the place of another one.
  void KeepPlants(const IkProblem& before);

  // Goals of several priorities, be they on or off, or such that couple
  // branches: for PrioritizedSolver.
  bool needs_levels() const { return needs_levels_; }

  // For solvers, by goal.
  const SparseTree& tree() const { return *tree_; }
  absl::Span<const kernel::TaskTarget> targets() const { return targets_; }
  // Not null when the problem is one goal, of a kind and weight that the
  // kernels of arms know, on the tip of an arm.
  const SerialArm* arm() const;

  bool has_free_plants() const { return free_plant_count_ > 0; }
  // The same with every plant captured at `positions`, into a solver's memory.
  void CopyTargets(const ConstVectorView& positions,
                   std::vector<kernel::TaskTarget>& targets) const;

  // The postures, joined: on the tree's columns, and of joints outside the
  // tree, which nothing else pulls.
  absl::Span<const kernel::PostureTerm> posture() const {
    return absl::MakeSpan(posture_).first(posture_on_tree_);
  }
  absl::Span<const kernel::PostureTerm> outside_posture() const {
    return absl::MakeSpan(posture_).subspan(posture_on_tree_);
  }

  // Without skeleton and tree.
  size_t ByteSize() const;

 private:
  IkProblem(std::shared_ptr<const Skeleton> skeleton, std::vector<Goal> goals,
            std::shared_ptr<const SparseTree> tree, bool needs_levels);
  // Bring targets_ and posture_ up to goals_.
  void RefreshTarget(int goal_index);
  void RefreshWeights(int goal_index);
  void RefreshPosture();
  bool IsFreePlant(int goal_index) const;

  std::shared_ptr<const Skeleton> skeleton_;
  std::vector<Goal> goals_;
  std::shared_ptr<const SparseTree> tree_;
  bool needs_levels_;
  std::vector<kernel::TaskTarget> targets_;
  int free_plant_count_ = 0;  // on, without a pose to hold
  std::vector<kernel::PostureTerm> posture_;
  int posture_on_tree_ = 0;
  // First column of each joint; empty without postures.
  std::vector<int> tree_columns_;
  RigidTransform world_from_skeleton_;
};

// Where an end effector of the problem's skeleton is. Cost: linear in its
// depth.
RigidTransform WorldFromEffector(const IkProblem& problem,
                                 absl::string_view effector_id,
                                 const ConstVectorView& positions);

}  // namespace gelenk

#endif  // GELENK_IK_IK_PROBLEM_H_
