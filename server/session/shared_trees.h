// The trees that the sessions of one skeleton are solved on, each kept once: a
// tree is some 10 KB, and ten thousand sessions of a game tend to have goals at
// the same effectors.
//
// Thread-safe. A tree goes with the last session that is solved on it.
#ifndef GELENK_SERVER_SESSION_SHARED_TREES_H_
#define GELENK_SERVER_SESSION_SHARED_TREES_H_

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/solver_options.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::server {

class SharedTrees {
 public:
  explicit SharedTrees(std::shared_ptr<const Skeleton> skeleton);

  const std::shared_ptr<const Skeleton>& skeleton() const { return skeleton_; }

  // As IkProblem::Create, on a shared tree, and checked as IkSolver::Check does
  // it: its violations are below "solver_options".
  absl::StatusOr<IkProblem> CreateProblem(std::vector<Goal> goals,
                                          const SolverOptions& options = {});

  // Trees that some problem is on.
  int tree_count() const;

 private:
  std::shared_ptr<const SparseTree> Find(absl::Span<const EffectorTask> tasks);

  const std::shared_ptr<const Skeleton> skeleton_;
  mutable std::mutex mutex_;
  // By the bits of the tasks.
  std::map<std::string, std::weak_ptr<const SparseTree>> trees_
      ABSL_GUARDED_BY(mutex_);
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_SHARED_TREES_H_
