// Residuals and Jacobians of goals at a pose, dense: for whatever is not solved
// on the sparse tree, for diagnoses, and as its oracle in tests.
//
// World frame, m, rad; columns by JointType's velocities. Rows are those of
// kernel::GoalRows, without weights. A posture has none. Cost: forward
// kinematics, then per goal linear in the depth of its frames (in the joints,
// for a centre of mass). Keeps its working memory. Not thread-safe.
#ifndef GELENK_IK_GOAL_LINEARIZER_H_
#define GELENK_IK_GOAL_LINEARIZER_H_

#include <Eigen/Core>
#include <vector>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/kinematics/center_of_mass.h"
#include "gelenk/kinematics/forward_kinematics.h"

namespace gelenk {

class GoalLinearizer {
 public:
  // Row-major, with as many rows as the goal has.
  using JacobianView = Eigen::Ref<
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

  // Takes up a problem, whose goals must keep their kinds from here on.
  void SetProblem(const IkProblem& problem);

  // Takes up a pose.
  void MoveTo(const ConstVectorView& positions);

  const WorldTransforms& world_from_joints() const { return frames_; }
  // What a goal looks at.
  const EffectorTask& task(int goal_index) const { return tasks_[goal_index]; }

  static int RowCount(const kernel::TaskTarget& target) {
    return target.translation_rows + target.rotation_rows;
  }

  // What one goal asks for; `target` is that of the problem or one like it.
  void Evaluate(int goal_index, const kernel::TaskTarget& target,
                kernel::GoalRows& rows);

  // After Evaluate of the same goal: by how much each residual falls per unit
  // of velocity. `jacobian` is overwritten.
  void ComputeJacobian(int goal_index, const kernel::TaskTarget& target,
                       const kernel::GoalRows& rows,
                       const ConstVectorView& positions, JacobianView jacobian);

 private:
  const IkProblem* problem_ = nullptr;
  std::vector<EffectorTask> tasks_;
  WorldTransforms frames_;
  CenterOfMass center_of_mass_;
};

}  // namespace gelenk

#endif  // GELENK_IK_GOAL_LINEARIZER_H_
