// Targets and starts for one skeleton: what `gelenk bench ik` measures on.
#ifndef CLIENT_CLI_BENCH_IK_SET_H_
#define CLIENT_CLI_BENCH_IK_SET_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cli/bench/number_table.h"
#include "gelenk/ik/goal.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::cli {

enum class BenchStart { kCold, kWarm };
enum class BenchGoal { kPose, kPosition };

struct IkSet {
  std::shared_ptr<const Skeleton> skeleton;
  // One a tip; the targets are those of the first problem.
  std::vector<Goal> goals;
  BenchGoal goal = BenchGoal::kPose;
  // [problem * goals.size() + goal], world frame.
  std::vector<RigidTransform> targets;
  // position_count a column; one for all problems, or one each.
  Eigen::MatrixXd starts;
  // Numbers of q that the tips depend on, in order of q, and the names of their
  // columns in a file of answers.
  std::vector<int> coordinates;
  std::vector<std::string> coordinate_names;

  int size() const { return static_cast<int>(targets.size() / goals.size()); }
  const RigidTransform& target(int problem, int goal_index) const {
    return targets[goals.size() * problem + goal_index];
  }
  Eigen::MatrixXd::ConstColXpr start(int problem) const {
    return starts.col(starts.cols() == 1 ? 0 : problem);
  }
};

// `tips` are end effectors or joints. `table` has
//   px,py,pz and qx,qy,qz,qw   the pose of the tip (of the second tip px1, ...;
//                              without the rotation only its position counts),
//                              or
//   q0, q1, ...                joint values whose forward kinematics is the
//                              target; and for a warm start
//   warm0, warm1, ...          joint values to start from.
// Joint values are those of the movable joints between the root and the tips,
// or of all movable joints, in order of the skeleton. Where both are given the
// pose counts. A cold start is the middle of each range, 0 where there is none.
//
// INVALID_ARGUMENT naming column and row of what is missing, out of place or no
// rotation.
absl::StatusOr<IkSet> MakeIkSet(std::shared_ptr<const Skeleton> skeleton,
                                const std::vector<std::string>& tips,
                                const NumberTable& table, BenchStart start,
                                BenchGoal goal);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_BENCH_IK_SET_H_
