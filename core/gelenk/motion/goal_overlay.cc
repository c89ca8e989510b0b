#include "gelenk/motion/goal_overlay.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/slerp.h"

namespace gelenk {
namespace {

// No client would call a goal that.
constexpr absl::string_view kPostureId = "(pose of the clips)";

// Goals whose target is a place of their effector.
bool IsPlacement(const GoalKind& kind) {
  return std::holds_alternative<PositionGoal>(kind) ||
         std::holds_alternative<RotationGoal>(kind) ||
         std::holds_alternative<PoseGoal>(kind);
}

void CheckTargets(const std::string& field, TimedGoal& timed,
                  Violations& violations) {
  if (!timed.targets.empty() && !IsPlacement(timed.goal.kind)) {
    violations.Add(field, absl::StrCat("want none of the kind ",
                                       GoalKindName(timed.goal.kind)));
    return;
  }
  for (size_t i = 0; i < timed.targets.size(); ++i) {
    TargetKey& key = timed.targets[i];
    const std::string path = absl::StrCat(field, "[", i, "]");
    if (!std::isfinite(key.time_s) ||
        (i > 0 && key.time_s <= timed.targets[i - 1].time_s)) {
      violations.Add(
          absl::StrCat(path, ".time_s"),
          absl::StrCat("want finite times that grow, got ", key.time_s));
    }
    GoalTarget target = key.world_pose;
    violations.AddStatus(absl::StrCat(path, ".world_pose"),
                         CheckAndNormalize(target));
    key.world_pose = std::get<RigidTransform>(target);
  }
}

void CheckTimedGoal(const std::string& field, TimedGoal& timed,
                    Violations& violations) {
  if (std::holds_alternative<PostureGoal>(timed.goal.kind)) {
    violations.Add(absl::StrCat(field, ".goal"),
                   "a posture: the clips' pose is the posture");
  }
  if (timed.goal.priority > kMaxOverlayPriority) {
    violations.Add(absl::StrCat(field, ".goal.priority"),
                   absl::StrCat("want at most ", kMaxOverlayPriority,
                                ", the clips' pose comes next, got ",
                                timed.goal.priority));
  }
  timed.weight.Check(absl::StrCat(field, ".weight"), 0, violations);
  for (const WeightKey& key : timed.weight.keys()) {
    if (key.weight > 1) {
      violations.Add(absl::StrCat(field, ".weight"),
                     absl::StrCat("want at most 1, got ", key.weight));
    }
  }
  CheckTargets(absl::StrCat(field, ".targets"), timed, violations);
}

RigidTransform Between(const RigidTransform& from, const RigidTransform& to,
                       double u) {
  RigidTransform between;
  between.translation =
      from.translation + u * (to.translation - from.translation);
  between.rotation = Slerp(from.rotation, to.rotation, u);
  return between;
}

RigidTransform At(const std::vector<TargetKey>& keys, double time_s) {
  const auto after = std::upper_bound(
      keys.begin(), keys.end(), time_s,
      [](double time, const TargetKey& key) { return time < key.time_s; });
  if (after == keys.begin()) return keys.front().world_pose;
  if (after == keys.end()) return keys.back().world_pose;
  const TargetKey& before = *(after - 1);
  return Between(before.world_pose, after->world_pose,
                 (time_s - before.time_s) / (after->time_s - before.time_s));
}

// A whole pose for any target of a placement; what it lacks is as in `other`.
RigidTransform WholePose(const GoalTarget& target,
                         const RigidTransform& other) {
  RigidTransform pose = other;
  if (const auto* place = std::get_if<Eigen::Vector3d>(&target)) {
    pose.translation = *place;
  } else if (const auto* rotation = std::get_if<Eigen::Quaterniond>(&target)) {
    pose.rotation = *rotation;
  } else {
    pose = std::get<RigidTransform>(target);
  }
  return pose;
}

}  // namespace

absl::StatusOr<GoalOverlay> GoalOverlay::Create(
    std::shared_ptr<const Skeleton> skeleton, std::vector<TimedGoal> goals,
    const SolverOptions& options, const RigidTransform& world_from_skeleton) {
  Violations violations;
  std::vector<Goal> all;
  for (size_t i = 0; i < goals.size(); ++i) {
    CheckTimedGoal(absl::StrCat("goals[", i, "]"), goals[i], violations);
    all.push_back(goals[i].goal);
  }
  Goal posture;
  posture.id = std::string(kPostureId);
  posture.priority = kMaxPriorities - 1;
  PostureGoal pose;
  pose.positions = skeleton->rest_positions();
  posture.kind = std::move(pose);
  all.push_back(std::move(posture));
  absl::StatusOr<IkProblem> problem =
      IkProblem::Create(skeleton, std::move(all));
  violations.AddStatus("", problem.status());
  violations.AddStatus("solver_options", CheckSolverOptions(options));
  if (!violations.empty()) return violations.ToStatus();
  if (absl::Status status = IkSolver::Check(*problem, options); !status.ok()) {
    return status;
  }
  problem->SetWorldFromSkeleton(world_from_skeleton);

  GoalOverlay overlay(*std::move(problem), options);
  overlay.posture_ = skeleton->rest_positions();
  for (size_t i = 0; i < goals.size(); ++i) {
    // As the problem has normalised it.
    const Goal& goal = overlay.problem_.goals()[i];
    Track& track = overlay.tracks_.emplace_back();
    track.weight = goals[i].weight;
    track.full_weight = goal.weight;
    track.targets = std::move(goals[i].targets);
    track.own_target = TargetOf(goal.kind);
    if (IsPlacement(goal.kind)) {
      track.effector = skeleton->FindEffector(EffectorId(goal.kind));
    }
  }
  return overlay;
}

RigidTransform GoalOverlay::WorldPoseOf(const Track& track) const {
  return frames_[track.effector->joint] * track.effector->joint_from_effector;
}

GoalTarget GoalOverlay::TargetAt(const Track& track, double time_s,
                                 double weight) const {
  const RigidTransform from = WorldPoseOf(track);
  const RigidTransform wanted = track.targets.empty()
                                    ? WholePose(track.own_target, from)
                                    : At(track.targets, time_s);
  const RigidTransform target = Between(from, wanted, weight);
  if (std::holds_alternative<Eigen::Vector3d>(track.own_target)) {
    return target.translation;
  }
  if (std::holds_alternative<Eigen::Quaterniond>(track.own_target)) {
    return target.rotation;
  }
  return target;
}

void GoalOverlay::Apply(double time_s, IkSolver& solver, VectorView positions,
                        SolveReport& report) {
  ForwardKinematics(problem_.skeleton(), positions,
                    problem_.world_from_skeleton(), frames_);
  bool any_is_on = false;
  for (size_t i = 0; i < tracks_.size(); ++i) {
    const Track& track = tracks_[i];
    const int index = static_cast<int>(i);
    const double weight = track.weight.At(time_s);
    if (!track.effector) {
      problem_.SetWeight(index, weight * track.full_weight);
    } else {
      problem_.SetWeight(index, weight > 0 ? track.full_weight : 0);
      problem_.SetTarget(index, TargetAt(track, time_s, weight));
    }
    any_is_on |= weight * track.full_weight > 0;
  }
  if (!any_is_on) {
    report = SolveReport();
  } else {
    std::get<Eigen::VectorXd>(posture_) = positions;
    problem_.SetTarget(static_cast<int>(tracks_.size()), posture_);
    problem_.CapturePlants(positions);
    solver.Solve(problem_, options_, SolveStart::kWarm, positions, report);
  }
  report.position_errors_m.resize(tracks_.size());
  report.rotation_errors_rad.resize(tracks_.size());
}

}  // namespace gelenk
