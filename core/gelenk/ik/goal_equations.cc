#include "gelenk/ik/goal_equations.h"

#include <cmath>
#include <optional>

#include "gelenk/kinematics/jacobian.h"
#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

// What a goal of one of the three kinds asks for.
struct Wish {
  std::optional<Eigen::Vector3d> world_position;
  AxisMask position_axes;
  std::optional<Eigen::Quaterniond> world_rotation;
  AxisMask rotation_axes;
  double rotation_scale = 1;
};

Wish WishOf(const GoalKind& kind) {
  Wish wish;
  if (const auto* position = std::get_if<PositionGoal>(&kind)) {
    wish.world_position = position->world_position;
    wish.position_axes = position->axes;
  } else if (const auto* rotation = std::get_if<RotationGoal>(&kind)) {
    wish.world_rotation = rotation->world_rotation;
    wish.rotation_axes = rotation->axes;
  } else if (const auto* pose = std::get_if<PoseGoal>(&kind)) {
    wish.world_position = pose->world_pose.translation;
    wish.position_axes = pose->axes;
    wish.rotation_scale = pose->rotation_scale_m_per_rad;
    if (wish.rotation_scale > 0) {
      wish.world_rotation = pose->world_pose.rotation;
      wish.rotation_axes = pose->rotation_axes;
    }
  }
  return wish;
}

bool Counts(const AxisMask& axes, int k) {
  return k == 0 ? axes.x : k == 1 ? axes.y : axes.z;
}

int RowCount(const Wish& wish) {
  int count = 0;
  for (int k = 0; k < 3; ++k) {
    count += wish.world_position && Counts(wish.position_axes, k) ? 1 : 0;
    count += wish.world_rotation && Counts(wish.rotation_axes, k) ? 1 : 0;
  }
  return count;
}

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// How the rotation vector r of R changes when R turns with angular velocity w
// in outer axes: dr/dt = InverseLeftJacobian(r) w.
Eigen::Matrix3d InverseLeftJacobian(const Eigen::Vector3d& r) {
  const double angle = r.norm();
  const Eigen::Matrix3d cross = CrossMatrix(r);
  // (1 - (angle/2) cot(angle/2)) / angle^2; its series where that cancels.
  const double factor =
      angle < 1e-2
          ? 1.0 / 12 + angle * angle / 720
          : (1 - 0.5 * angle * std::cos(angle / 2) / std::sin(angle / 2)) /
                (angle * angle);
  return Eigen::Matrix3d::Identity() - 0.5 * cross + factor * cross * cross;
}

// Numbers of a joint that cannot change.
bool IsFrozen(const Skeleton& skeleton, int joint, int k) {
  const JointType type = skeleton.joint(joint).type;
  // Quaternions have no box; the first three numbers of a free joint have.
  if (type == JointType::kSpherical) return false;
  if (type == JointType::kFree && k >= 3) return false;
  const int q = skeleton.span(joint).position_offset + k;
  const PositionBounds& bounds = skeleton.position_bounds();
  return bounds.lower[q] == bounds.upper[q];
}

}  // namespace

bool GoalEquations::Fit(const IkProblem& problem) {
  for (const Goal& goal : problem.goals()) {
    if (!std::holds_alternative<PositionGoal>(goal.kind) &&
        !std::holds_alternative<RotationGoal>(goal.kind) &&
        !std::holds_alternative<PoseGoal>(goal.kind)) {
      return false;
    }
  }
  return true;
}

GoalEquations::GoalEquations(const IkProblem& problem) : problem_(problem) {
  const Skeleton& skeleton = problem.skeleton();
  // Of those that own numbers; a mimic joint stands for the one it follows.
  std::vector<bool> moves(skeleton.joint_count(), false);
  for (const Goal& goal : problem.goals()) {
    declared_row_count_ += RowCount(WishOf(goal.kind));
    AddPath(skeleton.FindEffector(EffectorId(goal.kind))->joint, moves);
  }
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const int v = skeleton.span(i).velocity_offset;
    if (!moves[i] || v < 0) continue;
    moving_joints_.push_back(i);
    for (int k = 0; k < VelocityCount(skeleton.joint(i).type); ++k) {
      if (!IsFrozen(skeleton, i, k)) unknowns_.push_back(v + k);
    }
  }
}

void GoalEquations::AddPath(int joint, std::vector<bool>& moves) const {
  const Skeleton& skeleton = problem_.skeleton();
  for (int i = joint; i >= 0; i = skeleton.span(i).parent) {
    const int mimicked = skeleton.span(i).mimicked;
    moves[mimicked < 0 ? i : mimicked] = true;
  }
}

void GoalEquations::Evaluate(const ConstVectorView& positions) {
  const Skeleton& skeleton = problem_.skeleton();
  const size_t goal_count = problem_.goals().size();
  ForwardKinematics(skeleton, positions, problem_.world_from_skeleton(),
                    frames_);
  residual_.resize(declared_row_count_);
  jacobian_.resize(declared_row_count_, unknowns_.size());
  position_errors_m_.assign(goal_count, 0);
  rotation_errors_rad_.assign(goal_count, 0);
  int row = 0;
  const auto add = [&](double residual, const Eigen::RowVectorXd& derivative,
                       double scale) {
    residual_[row] = scale * residual;
    for (size_t c = 0; c < unknowns_.size(); ++c) {
      jacobian_(row, static_cast<int>(c)) = scale * derivative[unknowns_[c]];
    }
    ++row;
  };
  for (size_t g = 0; g < goal_count; ++g) {
    const Goal& goal = problem_.goals()[g];
    if (goal.weight == 0) continue;
    const Wish wish = WishOf(goal.kind);
    const EffectorFrame effector =
        *skeleton.FindEffector(EffectorId(goal.kind));
    const RigidTransform world_from_effector =
        frames_[effector.joint] * effector.joint_from_effector;
    ComputeJacobian(skeleton, positions, frames_, effector, geometric_);
    const double root = std::sqrt(goal.weight);
    if (wish.world_position) {
      const Eigen::Vector3d miss =
          world_from_effector.translation - *wish.world_position;
      double error2 = 0;
      for (int k = 0; k < 3; ++k) {
        if (!Counts(wish.position_axes, k)) continue;
        add(miss[k], geometric_.row(k), root);
        error2 += miss[k] * miss[k];
      }
      position_errors_m_[g] = std::sqrt(error2);
    }
    if (wish.world_rotation) {
      const Eigen::Vector3d miss = LogRotation(
          world_from_effector.rotation * wish.world_rotation->conjugate());
      const Eigen::MatrixXd derivative =
          InverseLeftJacobian(miss) * geometric_.bottomRows<3>();
      double error2 = 0;
      for (int k = 0; k < 3; ++k) {
        if (!Counts(wish.rotation_axes, k)) continue;
        add(miss[k], derivative.row(k), root * wish.rotation_scale);
        error2 += miss[k] * miss[k];
      }
      rotation_errors_rad_[g] = std::sqrt(error2);
    }
  }
  residual_.conservativeResize(row);
  jacobian_.conservativeResize(row, Eigen::NoChange);
}

}  // namespace gelenk
