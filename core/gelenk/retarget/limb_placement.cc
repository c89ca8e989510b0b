#include "gelenk/retarget/limb_placement.h"

#include <utility>

namespace gelenk {

using Eigen::Vector3d;

LimbPlacement::LimbPlacement(std::shared_ptr<const BodyModel> target)
    : target_(std::move(target)), pelvis_shift_(target_->legs) {
  const auto anatomy_of = [this](BodyRole role) -> const Eigen::Quaterniond& {
    return target_->anatomy[target_->map.joint(role)];
  };
  for (int side : kSides) {
    const LegRoles& leg = kLegRoles[side];
    const ArmRoles& arm = kArmRoles[side];
    if (target_->map.HasLeg(side)) {
      legs_[side].emplace(target_->legs[side], Vector3d::UnitX(),
                          anatomy_of(leg.thigh));
    }
    if (target_->map.HasArm(side)) {
      const double sign = side == kLeft ? -1 : 1;
      arms_[side].emplace(target_->arms[side], sign * Vector3d::UnitY(),
                          anatomy_of(arm.upper_arm));
    }
  }
}

void LimbPlacement::Reset() {
  pelvis_shift_.Reset();
  for (int side : kSides) {
    if (legs_[side]) legs_[side]->Reset();
    if (arms_[side]) arms_[side]->Reset();
  }
}

void LimbPlacement::Exchange(StateNumbers& state) {
  pelvis_shift_.Exchange(state);
  for (int side : kSides) {
    if (legs_[side]) legs_[side]->Exchange(state);
    if (arms_[side]) arms_[side]->Exchange(state);
  }
}

void LimbPlacement::PlaceLimb(BodyRole upper, BodyRole middle, BodyRole end,
                              const Vector3d& goal, double dt_s, LimbBend& bend,
                              RigPose& rig) {
  LimbPose limb = {rig.orientation(upper), rig.orientation(middle),
                   rig.place(upper), rig.place(middle), rig.place(end)};
  bend.Bend(goal, dt_s, limb);
  rig.SetWanted(target_->map.joint(upper), limb.upper);
  rig.SetWanted(target_->map.joint(middle), limb.lower);
}

Vector3d LimbPlacement::Apply(const LimbGoals& goals, double dt_s,
                              RigPose& rig) {
  Vector3d shift = Vector3d::Zero();
  if (goals.feet[kLeft] && goals.feet[kRight] && rig.CanTravel()) {
    std::array<Vector3d, 2> hips;
    std::array<Vector3d, 2> ankles;
    std::array<Vector3d, 2> wanted;
    for (int side : kSides) {
      hips[side] = rig.place(kLegRoles[side].thigh);
      ankles[side] = rig.place(kLegRoles[side].foot);
      wanted[side] = goals.feet[side]->ankle;
    }
    shift = pelvis_shift_.Update(hips, ankles, wanted, dt_s);
    rig.Shift(shift);
  }
  for (int side : kSides) {
    if (goals.feet[side] && legs_[side]) {
      const LegRoles& leg = kLegRoles[side];
      PlaceLimb(leg.thigh, leg.shin, leg.foot, goals.feet[side]->ankle, dt_s,
                *legs_[side], rig);
      rig.SetWanted(target_->map.joint(leg.foot),
                    goals.feet[side]->orientation);
      if (target_->map.Has(leg.toe)) {
        rig.SetWanted(target_->map.joint(leg.toe), goals.toes[side]);
      }
    }
    if (goals.hands[side] && arms_[side]) {
      const ArmRoles& arm = kArmRoles[side];
      PlaceLimb(arm.upper_arm, arm.forearm, arm.hand, *goals.hands[side], dt_s,
                *arms_[side], rig);
    }
  }
  rig.Follow();
  return shift;
}

}  // namespace gelenk
