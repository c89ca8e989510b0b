#include "gelenk/retarget/tracker_body.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "absl/memory/memory.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/contact/foot_points.h"
#include "gelenk/math/rotation.h"

namespace gelenk {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMinHeight = 0.5;
constexpr double kMaxHeight = 3;
constexpr double kMaxFrameTime_s = 10;

constexpr std::array<BodyRole, 6> kPartRoles = {
    BodyRole::kHead,   BodyRole::kLeftHand, BodyRole::kRightHand,
    BodyRole::kPelvis, BodyRole::kLeftFoot, BodyRole::kRightFoot};
constexpr std::array<absl::string_view, 6> kPartFields = {
    "head", "hands[0]", "hands[1]", "waist", "feet[0]", "feet[1]"};

// Of squared metres; what is guessed pulls far less than what is tracked.
constexpr double kTrackedWeight = 1;
constexpr double kSteppedFootWeight = 0.3;
constexpr double kGuessedWaistWeight = 0.01;
constexpr double kHeldWeight = 0.05;
constexpr double kPostureWeight = 2e-3;
constexpr double kScale_m_per_rad = 0.2;
constexpr int kMaxIterationsAFrame = 20;

// The hips turn after the head.
constexpr double kTurnTime_s = 0.25;
// Crouching people lean: the hips go back by this part of the way down.
constexpr double kLeanBack = 0.25;

double YawOf(const Quaterniond& rotation) {
  const Vector3d ahead = rotation * Vector3d::UnitZ();
  return std::atan2(ahead.x(), ahead.z());
}

Quaterniond YawRotation(double yaw_rad) {
  return Quaterniond(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitY()));
}

void Turn(const BodyModel& model, BodyRole role, double angle_rad,
          const Vector3d& axis, Eigen::VectorXd& positions) {
  const JointSpan& span = model.skeleton->span(model.map.joint(role));
  StoreXyzw(Quaterniond(Eigen::AngleAxisd(angle_rad, axis)),
            positions.data() + span.quaternion_offset);
}

// Arms down, elbows and knees a little bent.
Eigen::VectorXd RelaxedPositions(const BodyModel& model) {
  Eigen::VectorXd positions = model.skeleton->rest_positions();
  for (int side : kSides) {
    const double sign = side == kLeft ? -1 : 1;
    const ArmRoles& arm = kArmRoles[side];
    const LegRoles& leg = kLegRoles[side];
    Turn(model, arm.upper_arm, sign * 70 * kDegree, Vector3d::UnitZ(),
         positions);
    Turn(model, arm.forearm, sign * 25 * kDegree, Vector3d::UnitY(), positions);
    Turn(model, leg.thigh, -6 * kDegree, Vector3d::UnitX(), positions);
    Turn(model, leg.shin, 12 * kDegree, Vector3d::UnitX(), positions);
    Turn(model, leg.foot, -6 * kDegree, Vector3d::UnitX(), positions);
  }
  return positions;
}

}  // namespace

absl::StatusOr<std::unique_ptr<TrackerBody>> TrackerBody::Create(
    double height_m, InstructionSet level) {
  if (!(height_m >= kMinHeight && height_m <= kMaxHeight)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "height_m: want %g to %g, got %g", kMinHeight, kMaxHeight, height_m));
  }
  const std::shared_ptr<const Skeleton> skeleton = MakeHumanoid(height_m);
  absl::StatusOr<JointMap> map = ProposeJointMap(*skeleton);
  if (!map.ok()) return map.status();
  absl::StatusOr<std::shared_ptr<const BodyModel>> model =
      MakeBodyModel(skeleton, *map);
  if (!model.ok()) return model.status();
  std::vector<Goal> goals;
  for (BodyRole role : kPartRoles) {
    PoseGoal pose;
    pose.end_effector_id = skeleton->joint((*model)->map.joint(role)).id;
    pose.rotation_scale_m_per_rad = kScale_m_per_rad;
    Goal goal;
    goal.id = std::string(BodyRoleName(role));
    goal.kind = std::move(pose);
    goals.push_back(std::move(goal));
  }
  PostureGoal posture;
  posture.positions = RelaxedPositions(**model);
  // The root is where the goals have it.
  posture.joint_weights.assign(skeleton->joint_count(), 1);
  posture.joint_weights[0] = 0;
  Goal goal;
  goal.id = "posture";
  goal.weight = kPostureWeight;
  goal.kind = std::move(posture);
  goals.push_back(std::move(goal));
  absl::StatusOr<IkProblem> problem =
      IkProblem::Create(skeleton, std::move(goals));
  if (!problem.ok()) return problem.status();
  return absl::WrapUnique(
      new TrackerBody(*std::move(model), *std::move(problem), level));
}

TrackerBody::TrackerBody(std::shared_ptr<const BodyModel> model,
                         IkProblem problem, InstructionSet level)
    : model_(std::move(model)),
      problem_(std::move(problem)),
      solver_(level),
      steps_(0, 0, 1),
      relaxed_(RelaxedPositions(*model_)),
      positions_(relaxed_) {
  options_.max_iterations = kMaxIterationsAFrame;
  options_.max_restarts = 0;
  options_.detail = ReportDetail::kBrief;
  WorldTransforms rest;
  ForwardKinematics(*model_->skeleton, model_->skeleton->rest_positions(),
                    rest);
  for (int i = 0; i < kPartCount; ++i) {
    rest_[i] = rest[model_->map.joint(kPartRoles[i])];
  }
  steps_ = StepPlanner(
      (rest_[kLeftFoot].translation - rest_[kRightFoot].translation).norm(),
      rest_[kLeftFoot].translation.y(), model_->Size());
}

void TrackerBody::Reset() {
  positions_ = relaxed_;
  waist_from_part_ = {};
  steps_.Reset();
  yaw_rad_ = 0;
  is_first_ = true;
}

void TrackerBody::Exchange(StateNumbers& state) {
  state.Flag(is_first_);
  if (is_first_) {
    if (state.is_reading()) Reset();
    return;
  }
  state.Numbers(positions_);
  for (std::optional<RigidTransform>& part : waist_from_part_) {
    bool is_known = part.has_value();
    state.Flag(is_known);
    if (!is_known) {
      part.reset();
      continue;
    }
    if (!part) part.emplace();
    state.Place(*part);
  }
  steps_.Exchange(state);
  state.Number(yaw_rad_);
  if (!state.is_reading() || !state.ok()) return;
  const absl::Status status = CheckPositions(*model_->skeleton, positions_);
  if (!status.ok()) state.Refuse(status.message());
}

TrackerBody::Parts TrackerBody::PartsOf(const TrackerFrame& frame) {
  return {frame.head,  frame.hands[kLeft], frame.hands[kRight],
          frame.waist, frame.feet[kLeft],  frame.feet[kRight]};
}

void TrackerBody::Calibrate(const TrackerFrame& t_pose) {
  const Parts trackers = PartsOf(t_pose);
  for (int i = 0; i < kPartCount; ++i) {
    if (trackers[i]) mounts_[i] = trackers[i]->Inverse() * rest_[i];
  }
}

RigidTransform TrackerBody::GuessWaist(const Parts& tracked, double dt_s) {
  const RigidTransform& head = *tracked[kHead];
  double wanted = YawOf(head.rotation);
  if (tracked[kLeftHand] && tracked[kRightHand]) {
    // Hands that are apart tell where the chest looks; half of it.
    const Vector3d across = Horizontal(tracked[kLeftHand]->translation -
                                       tracked[kRightHand]->translation);
    const Vector3d ahead = across.cross(Vector3d::UnitY());
    const double reach = model_->arms[kLeft].Total();
    const double turn = std::remainder(
        std::atan2(ahead.x(), ahead.z()) - wanted, 2 * std::numbers::pi);
    if (across.norm() > reach && std::abs(turn) < 90 * kDegree) {
      wanted += turn / 2;
    }
  }
  const double turn = std::remainder(wanted - yaw_rad_, 2 * std::numbers::pi);
  yaw_rad_ += is_first_ ? turn : turn * (1 - std::exp(-dt_s / kTurnTime_s));
  const Quaterniond yaw = YawRotation(yaw_rad_);
  const double sunk =
      std::max(0.0, rest_[kHead].translation.y() - head.translation.y());
  const Vector3d below = rest_[kWaist].translation - rest_[kHead].translation;
  const Vector3d back(0, 0, -kLeanBack * sunk);
  return {yaw, head.translation + yaw * (below + back)};
}

void TrackerBody::Aim(int part, const RigidTransform& canonical_from_part,
                      double weight) {
  problem_.SetTarget(part, canonical_from_part);
  problem_.SetWeight(part, weight);
}

absl::Status TrackerBody::Update(const TrackerFrame& frame, double dt_s) {
  Parts tracked = PartsOf(frame);
  Violations violations;
  if (!(dt_s > 0) || dt_s > kMaxFrameTime_s) {
    violations.Add("dt_s", absl::StrFormat("want more than 0 and at most %g, "
                                           "got %g",
                                           kMaxFrameTime_s, dt_s));
  }
  for (int i = 0; i < kPartCount; ++i) {
    if (!tracked[i]) continue;
    GoalTarget target = *tracked[i];
    if (absl::Status status = CheckAndNormalize(target); !status.ok()) {
      violations.AddStatus(kPartFields[i], status);
      continue;
    }
    tracked[i] = std::get<RigidTransform>(target) * mounts_[i];
  }
  if (!tracked[kHead] && !waist_from_part_[kHead]) {
    violations.Add("head", "has never been tracked");
  }
  if (!violations.empty()) return violations.ToStatus();

  // Of a part that is lost, where it was; the hips are known from the last
  // pose.
  WorldTransforms& now = world_from_joints_;
  ForwardKinematics(*model_->skeleton, positions_, now);
  const RigidTransform hips = now[model_->map.joint(BodyRole::kPelvis)];
  std::array<bool, kPartCount> is_held = {};
  for (int i : {kHead, kLeftHand, kRightHand}) {
    if (tracked[i] || !waist_from_part_[i]) continue;
    tracked[i] = hips * *waist_from_part_[i];
    is_held[i] = true;
  }
  const bool has_waist = tracked[kWaist].has_value();
  if (has_waist) {
    yaw_rad_ = YawOf(tracked[kWaist]->rotation);
  } else {
    tracked[kWaist] = GuessWaist(tracked, dt_s);
  }
  if (is_first_) {
    // From far away the way would be long.
    const JointSpan& root = model_->skeleton->span(0);
    positions_.segment<3>(root.position_offset) = tracked[kWaist]->translation;
    StoreXyzw(YawRotation(yaw_rad_),
              positions_.data() + root.quaternion_offset);
  }
  const std::array<SteppingFoot, 2>& steps =
      steps_.Update(tracked[kWaist]->translation, yaw_rad_, dt_s);
  for (int i = 0; i < kPartCount; ++i) {
    const bool is_foot = i == kLeftFoot || i == kRightFoot;
    if (is_foot && !tracked[i]) {
      const SteppingFoot& foot = steps[i - kLeftFoot];
      Aim(i, {YawRotation(foot.yaw_rad), foot.ankle}, kSteppedFootWeight);
    } else if (!tracked[i]) {
      problem_.SetWeight(i, 0);
    } else if (i == kWaist && !has_waist) {
      Aim(i, *tracked[i], kGuessedWaistWeight);
    } else {
      Aim(i, *tracked[i], is_held[i] ? kHeldWeight : kTrackedWeight);
    }
  }
  solver_.Solve(problem_, options_, SolveStart::kWarm, positions_, report_);
  ForwardKinematics(*model_->skeleton, positions_, now);
  const RigidTransform hips_from_world =
      now[model_->map.joint(BodyRole::kPelvis)].Inverse();
  for (int i = 0; i < kPartCount; ++i) {
    if (tracked[i]) waist_from_part_[i] = hips_from_world * *tracked[i];
  }
  is_first_ = false;
  return absl::OkStatus();
}

}  // namespace gelenk
