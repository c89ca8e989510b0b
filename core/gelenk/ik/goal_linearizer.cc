#include "gelenk/ik/goal_linearizer.h"

#include "gelenk/ik/goals/frame_rows.h"
#include "gelenk/kinematics/joint_columns.h"

namespace gelenk {

using kernel::GoalShape;

void GoalLinearizer::SetProblem(const IkProblem& problem) {
  problem_ = &problem;
  tasks_.clear();
  for (const Goal& goal : problem.goals()) {
    tasks_.push_back(std::visit(
        [&](const auto& kind) { return TaskOf(problem.skeleton(), kind); },
        goal.kind));
  }
}

void GoalLinearizer::MoveTo(const ConstVectorView& positions) {
  ForwardKinematics(problem_->skeleton(), positions,
                    problem_->world_from_skeleton(), frames_);
}

void GoalLinearizer::Evaluate(int goal_index, const kernel::TaskTarget& target,
                              kernel::GoalRows& rows) {
  const EffectorTask& task = tasks_[goal_index];
  kernel::GoalFrame frames[kernel::kMaxGoalFrames];
  for (int f = 0; f < task.frame_count; ++f) {
    const EffectorFrame& effector = task.frames[f];
    const RigidTransform world_from_effector =
        frames_[effector.joint] * effector.joint_from_effector;
    Store(world_from_effector.translation, frames[f].translation);
    Store(world_from_effector.rotation.toRotationMatrix(), frames[f].rotation);
  }
  if (target.shape == GoalShape::kCenterOfMass) {
    Store(center_of_mass_.Compute(problem_->skeleton(), frames_),
          frames[0].translation);
  }
  LinearizeGoal(target, frames, rows);
}

void GoalLinearizer::ComputeJacobian(int goal_index,
                                     const kernel::TaskTarget& target,
                                     const kernel::GoalRows& rows,
                                     const ConstVectorView& positions,
                                     JacobianView jacobian) {
  const Skeleton& skeleton = problem_->skeleton();
  if (target.shape == GoalShape::kCenterOfMass) {
    center_of_mass_.ComputeJacobian(skeleton, positions, frames_, jacobian);
    return;
  }
  jacobian.setZero();
  const EffectorTask& task = tasks_[goal_index];
  JointColumns columns;
  for (int f = 0; f < task.frame_count; ++f) {
    const EffectorFrame& effector = task.frames[f];
    const Eigen::Vector3d tip =
        frames_[effector.joint] * effector.joint_from_effector.translation;
    for (int i = effector.joint; i >= 0; i = skeleton.span(i).parent) {
      const int count =
          ListJointColumns(skeleton, positions, frames_, i, columns);
      for (int k = 0; k < count; ++k) {
        const Eigen::Matrix<double, 6, 1> twist =
            columns[k].Twist(tip - frames_[i].translation);
        for (int r = 0; r < jacobian.rows(); ++r) {
          jacobian(r, columns[k].column) +=
              Eigen::Map<const Eigen::Matrix<double, 1, 6>>(rows.rows[f][r])
                  .dot(twist.transpose());
        }
      }
    }
  }
}

}  // namespace gelenk
