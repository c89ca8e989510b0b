// The goals of a problem as equations g(q) = 0, with their exact derivative:
// what the methods of Newton's kind work on.
//
// One row per axis that counts, of the goals that are on, in order of the
// goals; translations first: f(q) - X in m, world axes; then the rotation
// vector of effector * target^-1 in rad, world axes. Rows of masked axes are
// left out. One column per *unknown*: a degree of freedom of a joint that moves
// a goal and is not frozen.
//
// Rows are scaled by the square root of their goal's weight (and by
// rotation_scale_m_per_rad). While the goals can be met together this changes
// no step of a full row rank; where they cannot, it decides on the compromise.
//
// Position, rotation and pose goals. Allocates.
#ifndef GELENK_IK_GOAL_EQUATIONS_H_
#define GELENK_IK_GOAL_EQUATIONS_H_

#include <Eigen/Core>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

class GoalEquations {
 public:
  // True when all goals are of the kinds above.
  static bool Fit(const IkProblem& problem);

  // `problem` must fit and outlive this.
  explicit GoalEquations(const IkProblem& problem);

  // Rows of all goals, those that are switched off included.
  int declared_row_count() const { return declared_row_count_; }
  // Degrees of freedom that a column stands for, ascending.
  absl::Span<const int> unknowns() const { return unknowns_; }
  // Joints that move a goal, ascending.
  absl::Span<const int> moving_joints() const { return moving_joints_; }

  // Brings all of the following to `positions`.
  void Evaluate(const ConstVectorView& positions);

  const Eigen::VectorXd& residual() const { return residual_; }
  // residual.size() x unknowns().size().
  const Eigen::MatrixXd& jacobian() const { return jacobian_; }
  // Per goal, along the axes that count; 0 where a goal has none or is off.
  const std::vector<double>& position_errors_m() const {
    return position_errors_m_;
  }
  const std::vector<double>& rotation_errors_rad() const {
    return rotation_errors_rad_;
  }

 private:
  void AddPath(int joint, std::vector<bool>& moves) const;

  const IkProblem& problem_;
  int declared_row_count_ = 0;
  std::vector<int> unknowns_;
  std::vector<int> moving_joints_;
  WorldTransforms frames_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> geometric_;
  Eigen::VectorXd residual_;
  Eigen::MatrixXd jacobian_;
  std::vector<double> position_errors_m_;
  std::vector<double> rotation_errors_rad_;
};

}  // namespace gelenk

#endif  // GELENK_IK_GOAL_EQUATIONS_H_
