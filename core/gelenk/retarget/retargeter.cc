#include "gelenk/retarget/retargeter.h"

#include <cmath>
#include <utility>

#include "absl/memory/memory.h"
#include "absl/strings/str_format.h"

namespace gelenk {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

// How fast the body follows the ground that it walks over, s.
constexpr double kGroundTime_s = 0.2;

bool HaveSomethingInCommon(const JointMap& a, const JointMap& b) {
  for (int i = 0; i < kBodyRoleCount; ++i) {
    if (a.roles[i].joint >= 0 && b.roles[i].joint >= 0) return true;
  }
  return false;
}

}  // namespace

absl::StatusOr<std::unique_ptr<Retargeter>> Retargeter::Create(
    std::shared_ptr<const BodyModel> source,
    std::shared_ptr<const BodyModel> target, const RetargetOptions& options) {
  if (!HaveSomethingInCommon(source->map, target->map)) {
    return absl::InvalidArgumentError(
        "joint_map: source and target have no role in common");
  }
  absl::StatusOr<LimitKeeper> limits =
      LimitKeeper::Create(target, options.instruction_set);
  if (!limits.ok()) return limits.status();
  return absl::WrapUnique(new Retargeter(std::move(source), std::move(target),
                                         options, *std::move(limits)));
}

Retargeter::Retargeter(std::shared_ptr<const BodyModel> source,
                       std::shared_ptr<const BodyModel> target,
                       const RetargetOptions& options, LimitKeeper limits)
    : source_(std::move(source)),
      target_(std::move(target)),
      options_(options),
      ground_(options.target_ground != nullptr
                  ? options.target_ground
                  : std::make_shared<const FlatGround>()),
      reader_(source_),
      checked_(source_->skeleton->position_count()),
      detector_({source_->planted_heights, source_->leg_length},
                options.source_ground, options.contact_thresholds),
      transfer_(source_, target_, options.root_scale),
      rig_(target_),
      placement_(target_),
      limits_(std::move(limits)),
      limited_(target_->skeleton->joint_count()),
      has_feet_(source_->map.HasLegs() && target_->map.HasLegs()),
      positions_(target_->reference.positions),
      last_positions_(positions_) {
  if (!has_feet_) return;
  for (int side : kSides) {
    planters_[side].emplace(
        FootOnGround{target_->feet[side], target_->planted_heights[side],
                     *ground_},
        target_->Size());
  }
}

void Retargeter::Reset() {
  detector_.Reset();
  placement_.Reset();
  limits_.Reset();
  for (int side : kSides) {
    if (planters_[side]) planters_[side]->Reset();
  }
  is_first_ = true;
}

void Retargeter::Exchange(StateNumbers& state) {
  state.Flag(is_first_);
  if (is_first_) {
    if (state.is_reading()) Reset();
    return;
  }
  detector_.Exchange(state);
  placement_.Exchange(state);
  limits_.Exchange(state);
  for (int side : kSides) {
    if (planters_[side]) planters_[side]->Exchange(state);
  }
  state.Number(ground_m_);
}

absl::Status Retargeter::Retarget(const ConstVectorView& source_positions,
                                  double dt_s) {
  if (!(dt_s > 0) || dt_s > kMaxFrameTime_s) {
    return absl::InvalidArgumentError(
        absl::StrFormat("dt_s: want more than 0 and at most %g, got %g",
                        kMaxFrameTime_s, dt_s));
  }
  if (source_positions.size() != checked_.size()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("positions: want %d numbers, got %d", checked_.size(),
                        source_positions.size()));
  }
  checked_ = source_positions;
  if (absl::Status status = CheckPositions(*source_->skeleton, checked_);
      !status.ok()) {
    return status;
  }
  reader_.Read(checked_, source_pose_);
  RetargetBody(source_pose_, dt_s);
  return absl::OkStatus();
}

void Retargeter::RetargetBody(const BodyPose& source, double dt_s) {
  if (!source_->map.HasLegs()) {
    RetargetBody(source, FootContacts(), 0, dt_s);
    return;
  }
  const FootContacts& contacts = detector_.Update(source.foot_points, dt_s);
  RetargetBody(source, contacts, detector_.FloorAt(source.hip_center), dt_s);
}

FootPose Retargeter::FootGoal(const BodyPose& source, int side) const {
  const LegRoles& leg = kLegRoles[side];
  const double scale =
      target_->legs[side].Total() / source_->legs[side].Total();
  FootPose goal = {
      rig_.orientation(leg.foot),
      rig_.place(leg.thigh) +
          scale * (source.position(leg.foot) - source.position(leg.thigh))};
  goal.ankle.y() += ground_->HeightAt(goal.ankle) - ground_m_;
  return goal;
}

Quaterniond Retargeter::ToeGoal(const FootPose& foot, int side) const {
  const BodyRole toe = kLegRoles[side].toe;
  return target_->map.Has(toe) ? rig_.orientation(toe) : foot.orientation;
}

double Retargeter::FollowGround(const BodyPose& source, double dt_s) {
  const Vector3d below = transfer_.root_scale() * source.hip_center;
  const double height = ground_->HeightAt(below);
  ground_m_ = is_first_ ? height
                        : ground_m_ + (height - ground_m_) *
                                          (1 - std::exp(-dt_s / kGroundTime_s));
  return ground_m_;
}

void Retargeter::AimFeet(const BodyPose& source, double dt_s) {
  for (int side : kSides) {
    const FootPose goal = FootGoal(source, side);
    const Quaterniond toe = ToeGoal(goal, side);
    if (!options_.plant_feet) {
      goals_.feet[side] = goal;
      goals_.toes[side] = toe;
      continue;
    }
    const auto& contacts = report_.contacts[side];
    goals_.feet[side] = planters_[side]->Plant(goal, contacts, dt_s);
    goals_.toes[side] =
        planters_[side]->PlantToe(toe, contacts, dt_s, *goals_.feet[side]);
  }
}

void Retargeter::AimHands(const BodyPose& source) {
  for (int side : kSides) {
    goals_.hands[side].reset();
    if (!source_->map.HasArm(side) || !target_->map.HasArm(side)) continue;
    const ArmRoles& arm = kArmRoles[side];
    const double scale =
        target_->arms[side].Total() / source_->arms[side].Total();
    goals_.hands[side] =
        rig_.place(arm.upper_arm) +
        scale * (source.position(arm.hand) - source.position(arm.upper_arm));
  }
}

void Retargeter::MeasureErrors() {
  const bool is_limited =
      report_.limit_excess > 0 || limits_.SolvesEveryFrame();
  if (is_limited) ForwardKinematics(*target_->skeleton, positions_, limited_);
  const auto place = [&](BodyRole role) -> Vector3d {
    if (!is_limited) return rig_.place(role);
    return target_->canonical_from_world *
           limited_[target_->map.joint(role)].translation;
  };
  for (int side : kSides) {
    report_.hand_error_m[side] = 0;
    report_.foot_error_m[side] = 0;
    if (goals_.hands[side]) {
      report_.hand_error_m[side] =
          (place(kArmRoles[side].hand) - *goals_.hands[side]).norm();
    }
    if (goals_.feet[side]) {
      report_.foot_error_m[side] =
          (place(kLegRoles[side].foot) - goals_.feet[side]->ankle).norm();
    }
  }
}

void Retargeter::RetargetBody(const BodyPose& source,
                              const FootContacts& contacts,
                              double source_floor_m, double dt_s) {
  report_.contacts = contacts;
  report_.source_floor_m = source_floor_m;
  transfer_.Apply(source, source_floor_m, FollowGround(source, dt_s), rig_);
  if (options_.place_limbs && has_feet_) AimFeet(source, dt_s);
  Finish(source, dt_s);
}

Retargeter::CopiedFeet Retargeter::CopyFeet(const BodyPose& source,
                                            double source_floor_m,
                                            double dt_s) {
  transfer_.Apply(source, source_floor_m, FollowGround(source, dt_s), rig_);
  is_first_ = false;
  CopiedFeet copied;
  for (int side : kSides) {
    copied.feet[side] = FootGoal(source, side);
    copied.toes[side] = ToeGoal(copied.feet[side], side);
  }
  return copied;
}

void Retargeter::RetargetBody(const BodyPose& source,
                              const FootContacts& contacts,
                              double source_floor_m, const CopiedFeet& planned,
                              double dt_s) {
  report_.contacts = contacts;
  report_.source_floor_m = source_floor_m;
  transfer_.Apply(source, source_floor_m, FollowGround(source, dt_s), rig_);
  for (int side : kSides) {
    goals_.feet[side] = planned.feet[side];
    goals_.toes[side] = planned.toes[side];
  }
  Finish(source, dt_s);
}

void Retargeter::Finish(const BodyPose& source, double dt_s) {
  report_.pelvis_shift.setZero();
  if (options_.place_limbs) {
    AimHands(source);
    report_.pelvis_shift = placement_.Apply(goals_, dt_s, rig_);
  }
  last_positions_ = positions_;
  rig_.Store(positions_);
  report_.limit_excess = limits_.Keep(rig_, options_.keep_limits, positions_);
  if (options_.place_limbs) MeasureErrors();
  if (!is_first_) {
    AlignHemispheres(*target_->skeleton, last_positions_, positions_);
  }
  is_first_ = false;
}

}  // namespace gelenk
