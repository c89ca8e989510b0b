#include "client/cli/play/clip_goals.h"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/math/rotation.h"

namespace gelenk::cli {
namespace {

Goal PositionGoalFor(const std::string& effector_id) {
  Goal goal;
  goal.id = effector_id;
  PositionGoal position;
  position.end_effector_id = effector_id;
  goal.kind = std::move(position);
  return goal;
}

Goal PoseGoalFor(const std::string& effector_id) {
  Goal goal;
  goal.id = effector_id;
  PoseGoal pose;
  pose.end_effector_id = effector_id;
  goal.kind = std::move(pose);
  return goal;
}

std::vector<Goal> BodyGoals(const Skeleton& skeleton, const BodyParts& body) {
  std::vector<Goal> goals;
  goals.push_back(PoseGoalFor(skeleton.joint(body.hips).id));
  for (int joint : {body.left_hand, body.right_hand, body.left_foot,
                    body.right_foot, body.head}) {
    if (joint >= 0) goals.push_back(PositionGoalFor(skeleton.joint(joint).id));
  }
  return goals;
}

// The root, every end effector, and joints that carry nothing.
std::vector<Goal> EndGoals(const Skeleton& skeleton) {
  std::vector<bool> carries(skeleton.joint_count(), false);
  for (int i = 1; i < skeleton.joint_count(); ++i) {
    carries[skeleton.span(i).parent] = true;
  }
  std::vector<Goal> goals;
  goals.push_back(PoseGoalFor(skeleton.joint(0).id));
  for (const EndEffector& effector : skeleton.end_effectors()) {
    carries[skeleton.FindJoint(effector.joint_id)] = true;
    // A goal by this id means the end effector, also where a joint has it too.
    if (effector.id != goals.front().id) {
      goals.push_back(PositionGoalFor(effector.id));
    }
  }
  for (int i = 1; i < skeleton.joint_count(); ++i) {
    if (!carries[i]) goals.push_back(PositionGoalFor(skeleton.joint(i).id));
  }
  if (goals.size() > kMaxGoals) goals.resize(kMaxGoals);
  return goals;
}

}  // namespace

std::vector<Goal> GoalsFor(const Skeleton& skeleton, const BodyParts& body) {
  std::vector<Goal> goals = body.hips >= 0 && body.HasLimbs()
                                ? BodyGoals(skeleton, body)
                                : EndGoals(skeleton);
  WorldTransforms frames;
  ForwardKinematics(skeleton, skeleton.rest_positions(), frames);
  std::vector<GoalTarget> targets;
  TargetsAt(skeleton, goals, frames, targets);
  for (size_t i = 0; i < goals.size(); ++i) Retarget(goals[i].kind, targets[i]);
  return goals;
}

RigidTransform WorldFromEffector(const Skeleton& skeleton, const Goal& goal,
                                 const WorldTransforms& world_from_joints) {
  const EffectorFrame effector = *skeleton.FindEffector(EffectorId(goal.kind));
  return world_from_joints[effector.joint] * effector.joint_from_effector;
}

void TargetsAt(const Skeleton& skeleton, absl::Span<const Goal> goals,
               const WorldTransforms& world_from_joints,
               std::vector<GoalTarget>& targets) {
  targets.resize(goals.size());
  for (size_t i = 0; i < goals.size(); ++i) {
    const RigidTransform world_from_effector =
        WorldFromEffector(skeleton, goals[i], world_from_joints);
    if (std::holds_alternative<PositionGoal>(goals[i].kind)) {
      targets[i] = world_from_effector.translation;
    } else if (std::holds_alternative<RotationGoal>(goals[i].kind)) {
      targets[i] = world_from_effector.rotation;
    } else {
      targets[i] = world_from_effector;
    }
  }
}

GoalError ErrorOf(const Skeleton& skeleton, const Goal& goal,
                  const GoalTarget& target,
                  const WorldTransforms& world_from_joints) {
  const RigidTransform world_from_effector =
      WorldFromEffector(skeleton, goal, world_from_joints);
  GoalError error;
  if (const auto* point = std::get_if<Eigen::Vector3d>(&target)) {
    error.position_m = (world_from_effector.translation - *point).norm();
  } else if (const auto* turn = std::get_if<Eigen::Quaterniond>(&target)) {
    error.rotation_rad = AngleBetween(world_from_effector.rotation, *turn);
  } else {
    const auto& pose = std::get<RigidTransform>(target);
    error.position_m =
        (world_from_effector.translation - pose.translation).norm();
    error.rotation_rad =
        AngleBetween(world_from_effector.rotation, pose.rotation);
  }
  return error;
}

}  // namespace gelenk::cli
