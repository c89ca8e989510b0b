#include "gelenk/retarget/step_planner.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gelenk/contact/foot_points.h"

namespace gelenk {

using Eigen::Vector3d;

namespace {

// A foot that is farther from home, or turned by more, steps.
constexpr double kMaxDistance = 0.22;
constexpr double kMaxTurn = 35 * std::numbers::pi / 180;
constexpr double kStepTime_s = 0.35;
constexpr double kStepHeight = 0.08;
// Steps land ahead of hips that move on, and their speed is smoothed.
constexpr double kLead_s = 0.25;
constexpr double kSpeedTime_s = 0.15;
// A body that runs takes its steps faster.
constexpr double kHaste = 1.6;

double TurnBetween(double from, double to) {
  return std::remainder(to - from, 2 * std::numbers::pi);
}

}  // namespace

void StepPlanner::Exchange(StateNumbers& state) {
  state.Flag(is_first_);
  if (is_first_) return;
  for (int side : kSides) {
    feet_[side].Exchange(state);
    Step& step = steps_[side];
    state.Flag(step.is_on);
    if (!step.is_on) continue;
    state.Number(step.time_s);
    step.from.Exchange(state);
  }
  state.Vector(last_hips_);
  state.Vector(velocity_);
}

SteppingFoot StepPlanner::Home(int side, const Vector3d& hips,
                               double yaw_rad) const {
  const double out = side == kLeft ? half_width_m_ : -half_width_m_;
  const Vector3d left(std::cos(yaw_rad), 0, -std::sin(yaw_rad));
  Vector3d ankle =
      Horizontal(hips) + kLead_s * Horizontal(velocity_) + out * left;
  ankle.y() = ankle_height_m_;
  return {ankle, yaw_rad};
}

double StepPlanner::Strain(int side, const SteppingFoot& home) const {
  const double distance = Horizontal(home.ankle - feet_[side].ankle).norm();
  const double turn = std::abs(TurnBetween(feet_[side].yaw_rad, home.yaw_rad));
  return std::max(distance / (kMaxDistance * size_), turn / kMaxTurn);
}

void StepPlanner::Advance(int side, const SteppingFoot& home, double dt_s) {
  Step& step = steps_[side];
  const double haste = std::clamp(Strain(side, home), 1.0, kHaste);
  step.time_s += haste * dt_s;
  const double part = std::min(1.0, step.time_s / kStepTime_s);
  const double eased = part * part * (3 - 2 * part);
  SteppingFoot& foot = feet_[side];
  foot.ankle = step.from.ankle + eased * (home.ankle - step.from.ankle);
  foot.ankle.y() =
      ankle_height_m_ + kStepHeight * size_ * std::sin(std::numbers::pi * part);
  foot.yaw_rad =
      step.from.yaw_rad + eased * TurnBetween(step.from.yaw_rad, home.yaw_rad);
  if (part >= 1) step.is_on = false;
}

const std::array<SteppingFoot, 2>& StepPlanner::Update(const Vector3d& hips,
                                                       double yaw_rad,
                                                       double dt_s) {
  if (is_first_) {
    velocity_.setZero();
    steps_ = {};
  } else {
    const Vector3d velocity = (hips - last_hips_) / dt_s;
    velocity_ += (velocity - velocity_) * (1 - std::exp(-dt_s / kSpeedTime_s));
  }
  last_hips_ = hips;
  std::array<SteppingFoot, 2> homes;
  for (int side : kSides) {
    homes[side] = Home(side, hips, yaw_rad);
    if (is_first_) feet_[side] = homes[side];
  }
  is_first_ = false;
  if (!steps_[kLeft].is_on && !steps_[kRight].is_on) {
    const int side =
        Strain(kLeft, homes[kLeft]) >= Strain(kRight, homes[kRight]) ? kLeft
                                                                     : kRight;
    if (Strain(side, homes[side]) > 1) steps_[side] = {true, 0, feet_[side]};
  }
  for (int side : kSides) {
    if (steps_[side].is_on) Advance(side, homes[side], dt_s);
  }
  return feet_;
}

}  // namespace gelenk
