#include "gelenk/retarget/foot_planter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gelenk/math/rotation.h"

namespace gelenk {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double kDegree = std::numbers::pi / 180;
// Corrections fade to 5 % in this time after a lock is released.
constexpr double kReleaseTime_s = 0.35;
const double kReleaseExponent = 3 / kReleaseTime_s;
// The height of a locked point eases to the ground: faster than 30 ms doubles
// the peak of accelerations.
constexpr double kLandTime_s = 0.1;
// A foot that wants to be farther from its lock is let go, m.
constexpr double kMaxDrift = 0.1;
// A tip that asks for a larger turn of the toe is let go.
constexpr double kMaxTipTurn = 34 * kDegree;
constexpr double kToeTime_s = 0.03;
// High kicks and jumps ask for more: per second, and per frame where those are
// few.
constexpr double kMaxToeSpeed = 900 * kDegree;
constexpr double kMaxToeStep = 12 * kDegree;
// A foot on its tip has no direction.
constexpr double kMaxSteepness = 0.99;

double Approach(double dt_s, double time_s) {
  return 1 - std::exp(-dt_s / time_s);
}

Quaterniond Part(const Quaterniond& q, double part) {
  return Quaterniond::Identity().slerp(part, q);
}

// `arm` with its end at `height` above its beginning, in its vertical plane.
Vector3d AtHeight(const Vector3d& arm, double height) {
  const double length = arm.norm();
  const double sine =
      std::clamp(height / length, -kMaxSteepness, kMaxSteepness);
  const Vector3d ahead = Horizontal(arm).stableNormalized();
  return length * (ahead * std::sqrt(1 - sine * sine) + Vector3d(0, sine, 0));
}

constexpr double kNoLength = 1e-6;

}  // namespace

void LiftFoot(const FootOnGround& foot, int locked, FootPose& pose) {
  const Vector3d heel = pose * foot.shape.heel;
  const Vector3d ball = pose * foot.shape.ball;
  const double heel_depth = foot.PlantedHeight(kHeel, heel) - heel.y();
  const double ball_depth = foot.PlantedHeight(kBall, ball) - ball.y();
  if (locked == kNothingLocked) {
    pose.ankle.y() += std::max({heel_depth, ball_depth, 0.0});
    return;
  }
  const bool on_heel = locked == kHeel;
  const double depth = on_heel ? ball_depth : heel_depth;
  if (depth <= 1e-9) return;
  const Vector3d pivot = on_heel ? heel : ball;
  const Vector3d other = on_heel ? ball : heel;
  const Vector3d arm = other - pivot;
  if (Horizontal(arm).norm() < kNoLength) return;
  const Vector3d lifted = AtHeight(arm, other.y() + depth - pivot.y());
  pose.orientation = (ShortestRotation(arm.normalized(), lifted.normalized()) *
                      pose.orientation)
                         .normalized();
  pose.ankle =
      pivot - pose.orientation * (on_heel ? foot.shape.heel : foot.shape.ball);
}

Quaterniond LiftToe(const FootOnGround& foot, const Vector3d& ball,
                    const Quaterniond& toe) {
  if (!foot.shape.has_tip) return toe;
  const Vector3d arm = toe * foot.shape.tip;
  const double floor = foot.PlantedHeight(kTip, ball + arm);
  if (ball.y() + arm.y() >= floor) return toe;
  if (Horizontal(arm).norm() < kNoLength) return toe;
  const Vector3d lifted = AtHeight(arm, floor - ball.y());
  return (ShortestRotation(arm.normalized(), lifted.normalized()) * toe)
      .normalized();
}

void ToePlanter::Exchange(StateNumbers& state) {
  state.Flag(tip_is_held_);
  if (tip_is_held_) state.Vector(tip_);
  state.Rotation(turned_);
  state.Flag(is_first_);
}

void FootPlanter::Exchange(StateNumbers& state) {
  for (Lock& lock : locks_) {
    state.Flag(lock.is_on);
    if (!lock.is_on) continue;
    state.Vector(lock.place);
    state.Number(lock.age_s);
  }
  toe_.Exchange(state);
  state.Vector(moved_);
  state.Rotation(turned_);
  state.Flag(is_first_);
}

void FootPlanter::UpdateLock(int point, bool in_contact, const FootPose& goal,
                             const FootPose& pose, double dt_s) {
  Lock& lock = locks_[point];
  if (!in_contact) {
    lock.is_on = false;
    return;
  }
  if (!lock.is_on) lock = {true, pose * PointOf(point), 0};
  lock.age_s += dt_s;
  const Vector3d drift = goal * PointOf(point) - lock.place;
  if (Horizontal(drift).norm() > kMaxDrift * size_) {
    lock.is_on = false;
    return;
  }
  const double planted = foot_.PlantedHeight(point, lock.place);
  double& height = lock.place.y();
  height += (planted - height) * (is_first_ ? 1 : Approach(dt_s, kLandTime_s));
  height = std::max(height, planted);
}

void FootPlanter::StandOnBoth(FootPose& pose) {
  const int anchor = locks_[kHeel].age_s >= locks_[kBall].age_s ? kHeel : kBall;
  const int other = anchor == kHeel ? kBall : kHeel;
  const Vector3d& pivot = locks_[anchor].place;
  // The foot is rigid: the other lock keeps its direction and height.
  const Vector3d arm = PointOf(other) - PointOf(anchor);
  Vector3d wanted = locks_[other].place - pivot;
  if (Horizontal(wanted).norm() > kNoLength) {
    wanted = AtHeight(wanted.normalized() * arm.norm(), wanted.y());
  }
  locks_[other].place = pivot + wanted;
  if (arm.norm() > kNoLength && wanted.norm() > kNoLength) {
    const Vector3d now = pose.orientation * arm;
    pose.orientation =
        (ShortestRotation(now.normalized(), wanted.normalized()) *
         pose.orientation)
            .normalized();
  }
  pose.ankle = pivot - pose.orientation * PointOf(anchor);
}

FootPose FootPlanter::Plant(
    const FootPose& goal, const std::array<Contact, kFootPointCount>& contacts,
    double dt_s) {
  const double left = std::exp(-kReleaseExponent * dt_s);
  FootPose pose = {(Part(turned_, left) * goal.orientation).normalized(),
                   goal.ankle + left * moved_};
  for (int point : {kHeel, kBall}) {
    UpdateLock(point, contacts[point] == Contact::kPlanted, goal, pose, dt_s);
  }
  if (locks_[kHeel].is_on && locks_[kBall].is_on) {
    StandOnBoth(pose);
  } else if (locks_[kHeel].is_on || locks_[kBall].is_on) {
    const int point = locks_[kHeel].is_on ? kHeel : kBall;
    pose.ankle = locks_[point].place - pose.orientation * PointOf(point);
    LiftFoot(foot_, point, pose);
  } else {
    LiftFoot(foot_, kNothingLocked, pose);
  }
  moved_ = pose.ankle - goal.ankle;
  turned_ = pose.orientation * goal.orientation.conjugate();
  is_first_ = false;
  return pose;
}

Quaterniond FootPlanter::PlantToe(
    const Quaterniond& wanted,
    const std::array<Contact, kFootPointCount>& contacts, double dt_s,
    FootPose& planted) {
  const double height = planted.ankle.y();
  const Quaterniond toe =
      toe_.Plant({turned_, locks_[kBall].is_on, locks_[kHeel].is_on}, wanted,
                 contacts[kTip], dt_s, planted);
  moved_.y() += planted.ankle.y() - height;
  return toe;
}

void ToePlanter::HoldTip(const Vector3d& ball, bool holds, double dt_s,
                         Quaterniond& toe) {
  if (!holds || !foot_.shape.has_tip) {
    tip_is_held_ = false;
    return;
  }
  const Vector3d arm = toe * foot_.shape.tip;
  if (!tip_is_held_) tip_ = ball + arm;
  tip_is_held_ = true;
  tip_.y() += (foot_.PlantedHeight(kTip, tip_) - tip_.y()) *
              Approach(dt_s, kLandTime_s);
  const Vector3d wanted = tip_ - ball;
  if (wanted.norm() < kNoLength) return;
  const Quaterniond turn =
      ShortestRotation(arm.normalized(), wanted.normalized());
  if (AngleBetween(Quaterniond::Identity(), turn) > kMaxTipTurn) {
    tip_is_held_ = false;
    return;
  }
  toe = (turn * toe).normalized();
}

Quaterniond ToePlanter::Plant(const Foot& foot, const Quaterniond& wanted,
                              Contact tip, double dt_s, FootPose& pose) {
  const Vector3d ball = pose * foot_.shape.ball;
  Quaterniond toe = (foot.turned * wanted).normalized();
  HoldTip(ball, tip == Contact::kPlanted && foot.holds_ball, dt_s, toe);
  toe = LiftToe(foot_, ball, toe);
  const Quaterniond turn = toe * wanted.conjugate();
  const double way = AngleBetween(turned_, turn);
  const double most = std::min(kMaxToeSpeed * dt_s, kMaxToeStep);
  double part = is_first_ ? 1 : Approach(dt_s, kToeTime_s);
  if (!is_first_ && part * way > most) part = most / way;
  Quaterniond turned = turned_.slerp(part, turn);
  // Out of the ground as far as the speed allows.
  const Quaterniond lifted =
      LiftToe(foot_, ball, (turned * wanted).normalized()) * wanted.conjugate();
  const double lift = AngleBetween(turned, lifted);
  const double left = is_first_ ? lift : most - part * way;
  if (lift > 0) turned = turned.slerp(std::min(1.0, left / lift), lifted);
  turned_ = turned.normalized();
  is_first_ = false;
  toe = (turned_ * wanted).normalized();
  if (!foot_.shape.has_tip) return toe;
  const Vector3d at = ball + toe * foot_.shape.tip;
  const double depth = foot_.PlantedHeight(kTip, at) - at.y();
  if (depth <= 0) return toe;
  if (!foot.holds_heel && !foot.holds_ball) {
    pose.ankle.y() += depth;
    return toe;
  }
  // A foot that stands keeps its place: then the toe gives way.
  toe = LiftToe(foot_, ball, toe);
  turned_ = toe * wanted.conjugate();
  return toe;
}

}  // namespace gelenk
