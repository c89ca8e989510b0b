#include "tests/benchmarks/problems.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::benchmarks {
namespace {

using Eigen::Vector3d;

// Modified Denavit-Hartenberg row: Rx(alpha) Tx(a) Tz(d).
RigidTransform ModifiedDh(double a, double alpha, double d) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(alpha, Vector3d::UnitX()));
  return {turn, turn * Vector3d(a, 0, d)};
}

// Smooth in time, different for each coordinate, within [-1, 1].
double Wave(int frame, int coordinate) {
  const double t = frame / 60.0;
  return 0.7 * std::sin(t * (1.1 + 0.13 * (coordinate % 7)) + coordinate) +
         0.3 * std::sin(t * (2.3 + 0.17 * (coordinate % 5)) + 2 * coordinate);
}

GoalTarget TargetOf(const Goal& goal, const Skeleton& skeleton,
                    const WorldTransforms& world_from_joints) {
  const EffectorFrame effector = *skeleton.FindEffector(EffectorId(goal.kind));
  const RigidTransform world_from_effector =
      world_from_joints[effector.joint] * effector.joint_from_effector;
  if (std::holds_alternative<PositionGoal>(goal.kind)) {
    return world_from_effector.translation;
  }
  return world_from_effector;
}

// Targets along the motion that `move` gives.
template <typename Move>
StreamProblem Record(std::shared_ptr<const Skeleton> skeleton,
                     std::vector<Goal> goals, int frame_count, Move move) {
  StreamProblem problem;
  problem.skeleton = std::move(skeleton);
  problem.goals = std::move(goals);
  WorldTransforms frames;
  for (int f = 0; f < frame_count; ++f) {
    Eigen::VectorXd q = NeutralPositions(*problem.skeleton);
    move(f, q);
    ClampToLimits(*problem.skeleton, q);
    if (f == 0) problem.start = q;
    ForwardKinematics(*problem.skeleton, q, frames);
    std::vector<GoalTarget> targets;
    for (const Goal& goal : problem.goals) {
      targets.push_back(TargetOf(goal, *problem.skeleton, frames));
    }
    problem.frames.push_back(std::move(targets));
  }
  return problem;
}

struct Bone {
  const char* id;
  const char* parent;
  Vector3d offset_m;
};

// The hierarchy of the usual motion capture skeleton, 1.7 m tall.
const std::vector<Bone>& Bones() {
  static const auto& bones = *new std::vector<Bone>{
      {"hips", "", {0, 0.95, 0}},
      {"l_hip", "hips", {0, 0, 0}},
      {"l_thigh", "l_hip", {0.09, -0.05, 0}},
      {"l_shin", "l_thigh", {0, -0.42, 0}},
      {"l_foot", "l_shin", {0, -0.41, 0}},
      {"l_toe", "l_foot", {0, -0.05, 0.13}},
      {"r_hip", "hips", {0, 0, 0}},
      {"r_thigh", "r_hip", {-0.09, -0.05, 0}},
      {"r_shin", "r_thigh", {0, -0.42, 0}},
      {"r_foot", "r_shin", {0, -0.41, 0}},
      {"r_toe", "r_foot", {0, -0.05, 0.13}},
      {"spine0", "hips", {0, 0, 0}},
      {"spine1", "spine0", {0, 0.13, 0}},
      {"spine2", "spine1", {0, 0.13, 0}},
      {"neck0", "spine2", {0, 0.16, 0}},
      {"neck1", "neck0", {0, 0.05, 0}},
      {"head", "neck1", {0, 0.08, 0}},
      {"l_collar", "spine2", {0, 0.12, 0}},
      {"l_arm", "l_collar", {0.17, 0, 0}},
      {"l_forearm", "l_arm", {0.28, 0, 0}},
      {"l_hand", "l_forearm", {0.25, 0, 0}},
      {"l_palm", "l_hand", {0.03, 0, 0}},
      {"l_finger", "l_palm", {0.06, 0, 0}},
      {"l_thumb", "l_hand", {0.02, 0, 0.03}},
      {"r_collar", "spine2", {0, 0.12, 0}},
      {"r_arm", "r_collar", {-0.17, 0, 0}},
      {"r_forearm", "r_arm", {-0.28, 0, 0}},
      {"r_hand", "r_forearm", {-0.25, 0, 0}},
      {"r_palm", "r_hand", {-0.03, 0, 0}},
      {"r_finger", "r_palm", {-0.06, 0, 0}},
      {"r_thumb", "r_hand", {-0.02, 0, 0.03}},
  };
  return bones;
}

std::shared_ptr<const Skeleton> Body() {
  SkeletonBuilder builder;
  for (const Bone& bone : Bones()) {
    Joint joint;
    joint.id = bone.id;
    joint.parent_id = bone.parent;
    joint.type =
        joint.parent_id.empty() ? JointType::kFree : JointType::kSpherical;
    joint.parent_from_joint.translation = bone.offset_m;
    if (joint.type == JointType::kSpherical) {
      joint.limits.swing_cone_rad = 1.4;
      joint.limits.twist_lower_rad = -0.8;
      joint.limits.twist_upper_rad = 0.8;
    }
    builder.AddJoint(joint);
  }
  return *builder.Build();
}

}  // namespace

StreamProblem PandaProblem(int frame_count) {
  constexpr double kQuarter = std::numbers::pi / 2;
  const double a[] = {0, 0, 0, 0.0825, -0.0825, 0, 0.088};
  const double alpha[] = {0,         -kQuarter, kQuarter, kQuarter,
                          -kQuarter, kQuarter,  kQuarter};
  const double d[] = {0.333, 0, 0.316, 0, 0.384, 0, 0};
  const double lower[] = {-2.8973, -1.7628, -2.8973, -3.0718,
                          -2.8973, -0.0175, -2.8973};
  const double upper[] = {2.8973, 1.7628, 2.8973, -0.0698,
                          2.8973, 3.7525, 2.8973};
  SkeletonBuilder builder;
  for (int i = 0; i < 7; ++i) {
    Joint joint;
    joint.id = "joint" + std::to_string(i + 1);
    if (i > 0) joint.parent_id = "joint" + std::to_string(i);
    joint.type = JointType::kRevolute;
    joint.parent_from_joint = ModifiedDh(a[i], alpha[i], d[i]);
    joint.axis = Vector3d::UnitZ();
    joint.limits.lower = {lower[i]};
    joint.limits.upper = {upper[i]};
    builder.AddJoint(joint);
  }
  builder.AddEndEffector(
      {"flange",
       "joint7",
       {Eigen::Quaterniond::Identity(), Vector3d(0, 0, 0.107)}});
  PoseGoal goal;
  goal.end_effector_id = "flange";
  return Record(*builder.Build(), {{"flange", 1, goal}}, frame_count,
                [&](int frame, Eigen::VectorXd& q) {
                  for (int i = 0; i < 7; ++i) {
                    q[i] = 0.5 * (lower[i] + upper[i]) +
                           0.3 * (upper[i] - lower[i]) * Wave(frame, i);
                  }
                });
}

StreamProblem BodyProblem(int frame_count) {
  const std::shared_ptr<const Skeleton> skeleton = Body();
  std::vector<Goal> goals;
  PoseGoal hips;
  hips.end_effector_id = "hips";
  goals.push_back({"hips", 1, hips});
  for (const char* id : {"l_hand", "r_hand", "l_foot", "r_foot", "head"}) {
    PositionGoal goal;
    goal.end_effector_id = id;
    goals.push_back({id, 1, goal});
  }
  const auto move = [&](int frame, Eigen::VectorXd& q) {
    for (int i = 0; i < skeleton->joint_count(); ++i) {
      const int at = skeleton->span(i).position_offset;
      const Vector3d turn(Wave(frame, 3 * i), Wave(frame, 3 * i + 1),
                          Wave(frame, 3 * i + 2));
      const bool is_root = i == 0;
      StoreXyzw(ExpRotation(0.3 * turn), &q[is_root ? at + 3 : at]);
      if (is_root) q.segment<3>(at) = 0.3 * turn;
    }
  };
  return Record(skeleton, std::move(goals), frame_count, move);
}

StreamProblem StandingProblem(int frame_count, bool priorities) {
  StreamProblem problem;
  problem.skeleton = Body();
  const Skeleton& skeleton = *problem.skeleton;
  // Knees and elbows a little bent: straight ones are singular.
  problem.start = NeutralPositions(skeleton);
  const auto bend = [&](const char* id, const Vector3d& turn) {
    const int at = skeleton.span(skeleton.FindJoint(id)).quaternion_offset;
    StoreXyzw(ExpRotation(turn), &problem.start[at]);
  };
  for (const char* side : {"l", "r"}) {
    const std::string limb(side);
    const double sign = limb == "l" ? 1 : -1;
    bend((limb + "_thigh").c_str(), {-0.35, 0, 0});
    bend((limb + "_shin").c_str(), {0.7, 0, 0});
    bend((limb + "_foot").c_str(), {-0.35, 0, 0});
    bend((limb + "_arm").c_str(), {0, 0, -sign * 0.8});
    bend((limb + "_forearm").c_str(), {0, -sign * 0.8, 0});
  }
  WorldTransforms frames;
  ForwardKinematics(skeleton, problem.start, frames);
  for (const char* id : {"l_foot", "r_foot"}) {
    PoseGoal goal;
    goal.end_effector_id = id;
    goal.world_pose = frames[skeleton.FindJoint(id)];
    problem.goals.push_back({id, 1, goal, 0});
  }
  for (const char* id : {"l_hand", "r_hand"}) {
    PositionGoal goal;
    goal.end_effector_id = id;
    goal.world_position = frames[skeleton.FindJoint(id)].translation;
    problem.goals.push_back({id, 1, goal, priorities ? 1 : 0});
  }
  problem.goals.push_back({"posture", priorities ? 1 : 1e-4,
                           PostureGoal{problem.start, {}}, priorities ? 2 : 0});
  for (int f = 0; f < frame_count; ++f) {
    std::vector<GoalTarget> targets;
    for (size_t g = 0; g < problem.goals.size(); ++g) {
      targets.push_back(gelenk::TargetOf(problem.goals[g].kind));
      if (auto* point = std::get_if<Vector3d>(&targets.back())) {
        const int c = 3 * static_cast<int>(g);
        *point += 0.15 * Vector3d(Wave(f, c), Wave(f, c + 1), Wave(f, c + 2));
      }
    }
    problem.frames.push_back(std::move(targets));
  }
  return problem;
}

}  // namespace gelenk::benchmarks
