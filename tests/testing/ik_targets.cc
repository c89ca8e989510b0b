#include "tests/testing/ik_targets.h"

#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/skeleton/pose.h"
#include "tests/testing/matrix_kinematics_oracle.h"
#include "tests/testing/random_pose.h"

namespace gelenk::testing {
namespace {

AxisMask AxesOf(const GoalKind& kind) {
  if (const auto* position = std::get_if<PositionGoal>(&kind)) {
    return position->axes;
  }
  return std::get<PoseGoal>(kind).axes;
}

// The target as a frame; the part that the goal lacks is identity.
RigidTransform TargetFrame(const GoalKind& kind) {
  RigidTransform frame;
  if (const auto* position = std::get_if<PositionGoal>(&kind)) {
    frame.translation = position->world_position;
  } else if (const auto* rotation = std::get_if<RotationGoal>(&kind)) {
    frame.rotation = rotation->world_rotation;
  } else {
    frame = std::get<PoseGoal>(kind).world_pose;
  }
  return frame;
}

Eigen::Matrix4d OracleFrame(const Skeleton& skeleton, const Goal& goal,
                            const Eigen::VectorXd& positions) {
  return MatrixKinematicsOracle(skeleton, positions)
      .WorldFromEndEffector(EffectorId(goal.kind));
}

}  // namespace

Goal PositionGoalFor(const std::string& end_effector_id,
                     const Eigen::Vector3d& world_position) {
  PositionGoal kind;
  kind.end_effector_id = end_effector_id;
  kind.world_position = world_position;
  return {end_effector_id, 1, kind};
}

Goal RotationGoalFor(const std::string& end_effector_id,
                     const Eigen::Quaterniond& world_rotation) {
  RotationGoal kind;
  kind.end_effector_id = end_effector_id;
  kind.world_rotation = world_rotation;
  return {end_effector_id, 1, kind};
}

Goal PoseGoalFor(const std::string& end_effector_id,
                 const RigidTransform& world_pose) {
  PoseGoal kind;
  kind.end_effector_id = end_effector_id;
  kind.world_pose = world_pose;
  return {end_effector_id, 1, kind};
}

RigidTransform EffectorPose(const Skeleton& skeleton,
                            const Eigen::VectorXd& positions,
                            absl::string_view id) {
  WorldTransforms world_from_joints;
  ForwardKinematics(skeleton, positions, world_from_joints);
  const EffectorFrame effector = skeleton.FindEffector(id).value();
  RigidTransform pose =
      world_from_joints[effector.joint] * effector.joint_from_effector;
  pose.rotation.normalize();
  return pose;
}

std::vector<Goal> PoseGoalsAt(const Skeleton& skeleton,
                              const Eigen::VectorXd& positions) {
  std::vector<Goal> goals;
  for (const EndEffector& effector : skeleton.end_effectors()) {
    goals.push_back(PoseGoalFor(
        effector.id, EffectorPose(skeleton, positions, effector.id)));
  }
  return goals;
}

Eigen::VectorXd StartNear(Random& random, const Skeleton& skeleton,
                          const Eigen::VectorXd& positions, double size) {
  Eigen::VectorXd start(positions.size());
  Integrate(skeleton, positions, RandomVelocity(random, skeleton, size), start);
  ClampToLimits(skeleton, start);
  return start;
}

double OraclePositionError(const Skeleton& skeleton, const Goal& goal,
                           const Eigen::VectorXd& positions) {
  if (std::holds_alternative<RotationGoal>(goal.kind)) return 0;
  const Eigen::Vector3d reached =
      OracleFrame(skeleton, goal, positions).col(3).head<3>();
  Eigen::Vector3d error = reached - TargetFrame(goal.kind).translation;
  const AxisMask axes = AxesOf(goal.kind);
  if (!axes.x) error.x() = 0;
  if (!axes.y) error.y() = 0;
  if (!axes.z) error.z() = 0;
  return error.norm();
}

double OracleRotationError(const Skeleton& skeleton, const Goal& goal,
                           const Eigen::VectorXd& positions) {
  if (std::holds_alternative<PositionGoal>(goal.kind)) return 0;
  return AxesAngle(OracleFrame(skeleton, goal, positions),
                   MatrixOf(TargetFrame(goal.kind)));
}

}  // namespace gelenk::testing
