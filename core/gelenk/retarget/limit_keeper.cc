#include "gelenk/retarget/limit_keeper.h"

#include <algorithm>
#include <utility>

namespace gelenk {
namespace {

// Squared errors of metres; a rad of a foot counts as much as half a metre.
constexpr double kFootWeight = 1;
constexpr double kFootScale_m_per_rad = 0.5;
constexpr double kHandWeight = 0.1;
constexpr double kPostureWeight = 1e-4;
// A stream has no time for more; they bring feet within a millimetre.
constexpr int kMaxIterationsAFrame = 4;
// Less is the rounding of limits.
constexpr double kNoExcess = 1e-7;

bool IsLimited(const JointLimits& limits) {
  return !limits.lower.empty() || !limits.upper.empty() ||
         limits.HasRotationLimits();
}

}  // namespace

LimitKeeper::LimitKeeper(std::shared_ptr<const BodyModel> target,
                         IkProblem problem, std::vector<EndGoal> ends,
                         int posture)
    : target_(std::move(target)),
      problem_(std::move(problem)),
      ends_(std::move(ends)),
      posture_(posture),
      posture_target_(target_->reference.positions) {
  const auto joints = target_->skeleton->joints();
  has_limits_ = std::any_of(joints.begin(), joints.end(),
                            [](const Joint& j) { return IsLimited(j.limits); });
  options_.max_iterations = kMaxIterationsAFrame;
  options_.max_restarts = 0;
  options_.detail = ReportDetail::kBrief;
  wanted_.resize(joints.size());
}

absl::StatusOr<LimitKeeper> LimitKeeper::Create(
    std::shared_ptr<const BodyModel> target) {
  const JointMap& map = target->map;
  const Skeleton& skeleton = *target->skeleton;
  std::vector<Goal> goals;
  std::vector<EndGoal> ends;
  const auto add = [&](BodyRole role, double weight, bool has_rotation) {
    const std::string& id = skeleton.joint(map.joint(role)).id;
    ends.push_back(
        {static_cast<int>(goals.size()), map.joint(role), has_rotation});
    Goal goal;
    goal.id = std::string(BodyRoleName(role));
    goal.weight = weight;
    if (has_rotation) {
      PoseGoal pose;
      pose.end_effector_id = id;
      pose.rotation_scale_m_per_rad = kFootScale_m_per_rad;
      goal.kind = pose;
    } else {
      PositionGoal position;
      position.end_effector_id = id;
      goal.kind = position;
    }
    goals.push_back(std::move(goal));
  };
  for (int side : kSides) {
    if (map.HasLeg(side)) add(kLegRoles[side].foot, kFootWeight, true);
    if (map.HasArm(side)) add(kArmRoles[side].hand, kHandWeight, false);
  }
  const int posture = static_cast<int>(goals.size());
  Goal goal;
  goal.id = "posture";
  goal.weight = kPostureWeight;
  PostureGoal kind;
  kind.positions = target->reference.positions;
  goal.kind = std::move(kind);
  goals.push_back(std::move(goal));
  absl::StatusOr<IkProblem> problem =
      IkProblem::Create(target->skeleton, std::move(goals));
  if (!problem.ok()) return problem.status();
  return LimitKeeper(std::move(target), *std::move(problem), std::move(ends),
                     posture);
}

double LimitKeeper::Keep(VectorView positions) {
  if (!has_limits_) return 0;
  const Skeleton& skeleton = *target_->skeleton;
  const double excess = LimitExcess(skeleton, positions, nullptr);
  if (excess < kNoExcess) return 0;
  ForwardKinematics(skeleton, positions, wanted_);
  for (const EndGoal& end : ends_) {
    const RigidTransform& wanted = wanted_[end.joint];
    if (end.has_rotation) {
      problem_.SetTarget(end.goal, wanted);
    } else {
      problem_.SetTarget(end.goal, wanted.translation);
    }
  }
  std::get<Eigen::VectorXd>(posture_target_) = positions;
  problem_.SetTarget(posture_, posture_target_);
  ClampToLimits(skeleton, positions);
  solver_.Solve(problem_, options_, SolveStart::kWarm, positions, report_);
  return excess;
}

}  // namespace gelenk
