#include "gelenk/retarget/limit_keeper.h"

#include <algorithm>
#include <string>
#include <utility>

namespace gelenk {
namespace {

// Squared errors of metres; a rad of a foot counts as much as 12 cm, about what
// it moves the ball by. More would let ankles at their limits push the foot
// into the ground.
constexpr double kFootWeight = 10;
constexpr double kFootScale_m_per_rad = 0.12;
constexpr double kHandWeight = 0.3;
// Of squared rad: bones of robots, and what pulls towards the wanted pose.
constexpr double kBoneWeight = 1e-3;
constexpr double kPostureWeight = 3e-4;
// A stream has no time for more; they bring feet within a millimetre. Robots
// come from the frame before, not from the copied pose: first from nowhere.
constexpr int kMaxIterationsAFrame = 4;
constexpr int kMaxIterationsOfRobots = 20;
constexpr int kMaxIterationsAtFirst = 200;
// Less is the rounding of limits.
constexpr double kNoExcess = 1e-7;

bool IsLimited(const JointLimits& limits) {
  return !limits.lower.empty() || !limits.upper.empty() ||
         limits.HasRotationLimits();
}

// Roles whose bones are turned by a joint of one axis, or by several in a row.
bool HasScalarRoles(const BodyModel& model) {
  return std::any_of(
      model.map.roles.begin(), model.map.roles.end(),
      [&model](const RoleAssignment& role) {
        return role.joint >= 0 &&
               VelocityCount(model.skeleton->joint(role.joint).type) == 1;
      });
}

bool IsEnd(BodyRole role) {
  for (int side : kSides) {
    if (role == kLegRoles[side].foot || role == kLegRoles[side].toe) {
      return true;
    }
  }
  return role == BodyRole::kPelvis;
}

}  // namespace

LimitKeeper::LimitKeeper(std::shared_ptr<const BodyModel> target,
                         IkProblem problem, std::vector<PartGoal> parts,
                         bool solves_every_frame, InstructionSet level)
    : target_(std::move(target)),
      problem_(std::move(problem)),
      parts_(std::move(parts)),
      solves_every_frame_(solves_every_frame),
      solver_(level),
      posture_target_(target_->reference.positions),
      last_(target_->reference.positions) {
  const auto joints = target_->skeleton->joints();
  has_limits_ = std::any_of(joints.begin(), joints.end(),
                            [](const Joint& j) { return IsLimited(j.limits); });
  options_.max_restarts = 0;
  options_.detail = ReportDetail::kBrief;
}

absl::StatusOr<LimitKeeper> LimitKeeper::Create(
    std::shared_ptr<const BodyModel> target, InstructionSet level) {
  const JointMap& map = target->map;
  const Skeleton& skeleton = *target->skeleton;
  std::vector<Goal> goals;
  std::vector<PartGoal> parts;
  const auto add = [&](BodyRole role, double weight, Aim aim, GoalKind kind) {
    parts.push_back({map.joint(role), aim});
    Goal goal;
    goal.id = std::string(BodyRoleName(role));
    if (aim == Aim::kRotation) goal.id += ".rotation";
    goal.weight = weight;
    goal.kind = std::move(kind);
    goals.push_back(std::move(goal));
  };
  const auto id_of = [&](BodyRole role) {
    return skeleton.joint(map.joint(role)).id;
  };
  for (int side : kSides) {
    if (map.HasLeg(side)) {
      PoseGoal foot;
      foot.end_effector_id = id_of(kLegRoles[side].foot);
      foot.rotation_scale_m_per_rad = kFootScale_m_per_rad;
      add(kLegRoles[side].foot, kFootWeight, Aim::kPose, foot);
    }
    if (map.HasArm(side)) {
      PositionGoal hand;
      hand.end_effector_id = id_of(kArmRoles[side].hand);
      add(kArmRoles[side].hand, kHandWeight, Aim::kPosition, hand);
    }
  }
  const bool solves_every_frame = HasScalarRoles(*target);
  for (int i = 0; i < kBodyRoleCount && solves_every_frame; ++i) {
    const auto role = static_cast<BodyRole>(i);
    if (!map.Has(role) || IsEnd(role) ||
        skeleton.joint(map.joint(role)).type == JointType::kFixed) {
      continue;
    }
    RotationGoal bone;
    bone.end_effector_id = id_of(role);
    add(role, kBoneWeight, Aim::kRotation, bone);
  }
  Goal goal;
  goal.id = "posture";
  goal.weight = kPostureWeight;
  PostureGoal posture;
  posture.positions = target->reference.positions;
  goal.kind = std::move(posture);
  goals.push_back(std::move(goal));
  absl::StatusOr<IkProblem> problem =
      IkProblem::Create(target->skeleton, std::move(goals));
  if (!problem.ok()) return problem.status();
  return LimitKeeper(std::move(target), *std::move(problem), std::move(parts),
                     solves_every_frame, level);
}

void LimitKeeper::Reset() {
  last_ = target_->reference.positions;
  is_first_ = true;
}

void LimitKeeper::Exchange(StateNumbers& state) {
  if (!solves_every_frame_) return;
  state.Flag(is_first_);
  state.Numbers(last_);
  if (!state.is_reading() || !state.ok()) return;
  const absl::Status status = CheckPositions(*target_->skeleton, last_);
  if (!status.ok()) state.Refuse(status.message());
}

void LimitKeeper::AimParts(const RigPose& rig, const ConstVectorView& posture) {
  const Eigen::Quaterniond world_from_canonical =
      target_->canonical_from_world.conjugate();
  for (size_t i = 0; i < parts_.size(); ++i) {
    const int joint = parts_[i].joint;
    const RigidTransform wanted = {
        (world_from_canonical * rig.orientation(joint)).normalized(),
        world_from_canonical * rig.place(joint)};
    const int goal = static_cast<int>(i);
    switch (parts_[i].aim) {
      case Aim::kPose:
        problem_.SetTarget(goal, wanted);
        break;
      case Aim::kPosition:
        problem_.SetTarget(goal, wanted.translation);
        break;
      case Aim::kRotation:
        problem_.SetTarget(goal, wanted.rotation);
        break;
    }
  }
  std::get<Eigen::VectorXd>(posture_target_) = posture;
  problem_.SetTarget(static_cast<int>(parts_.size()), posture_target_);
}

void LimitKeeper::Solve(VectorView positions) {
  ClampToLimits(*target_->skeleton, positions);
  solver_.Solve(problem_, options_, SolveStart::kWarm, positions, report_);
}

double LimitKeeper::Keep(const RigPose& rig, bool keep_limits,
                         VectorView positions) {
  const Skeleton& skeleton = *target_->skeleton;
  const double excess =
      has_limits_ ? LimitExcess(skeleton, positions, nullptr) : 0;
  if (solves_every_frame_) {
    // The base is where the body is; the rest begins where it was.
    for (int i = 0; i < skeleton.joint_count(); ++i) {
      const JointSpan& span = skeleton.span(i);
      if (skeleton.joint(i).type == JointType::kFree) {
        last_.segment<7>(span.position_offset) =
            positions.segment<7>(span.position_offset);
      }
    }
    AimParts(rig, last_);
    options_.max_iterations =
        is_first_ ? kMaxIterationsAtFirst : kMaxIterationsOfRobots;
    Solve(last_);
    positions = last_;
    is_first_ = false;
    return excess;
  }
  if (!keep_limits || excess < kNoExcess) return 0;
  AimParts(rig, positions);
  options_.max_iterations = kMaxIterationsAFrame;
  Solve(positions);
  return excess;
}

}  // namespace gelenk
