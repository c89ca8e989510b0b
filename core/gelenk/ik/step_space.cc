#include "gelenk/ik/step_space.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "gelenk/ik/rotation_basis.h"
#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A rotation nearer than this to a limit has coordinates that know it, rad.
constexpr double kNear = 0.3;
// A cone this small allows no swing.
constexpr double kPointCone = 1e-6;
// A turn this small has no direction, rad.
constexpr double kNoTurn = 1e-9;
// Half edges of boxes in the unit ball: of a cube, and of a longer one.
constexpr double kCube = 0.577;
constexpr double kAlong = 0.9;
constexpr double kAcross = 0.3;
// Bounds of a turn and limits of a rotation are brought together in so many
// rounds; where they meet at a slant each leaves a part of the gap before.
constexpr int kBoundRounds = 16;

struct Range {
  double lower;
  double upper;
};

Range RangeOf(int velocity, std::optional<double> max_step,
              const StepBounds* bounds) {
  const double most = max_step.value_or(kInfinity);
  if (bounds == nullptr) return {-most, most};
  return {std::max(-most, bounds->lower[velocity]),
          std::min(most, bounds->upper[velocity])};
}

}  // namespace

void StepSpace::Reset(const Skeleton& skeleton, std::optional<double> max_step,
                      const StepBounds* bounds, const ConstVectorView& start) {
  skeleton_ = &skeleton;
  start_.assign(start.begin(), start.end());
  scalars_.clear();
  rotations_.clear();
  rotation_at_.assign(skeleton.velocity_count(), -1);
  lower_.assign(skeleton.velocity_count(), -kInfinity);
  upper_.assign(skeleton.velocity_count(), kInfinity);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (skeleton.span(j).velocity_offset >= 0) AddJoint(j, max_step, bounds);
  }
}

void StepSpace::AddJoint(int j, std::optional<double> max_step,
                         const StepBounds* bounds) {
  const JointSpan& span = skeleton_->span(j);
  const bool turns = span.quaternion_offset >= 0;
  const int scalars = VelocityCount(skeleton_->joint(j).type) - (turns ? 3 : 0);
  const PositionBounds& limits = skeleton_->position_bounds();
  for (int k = 0; k < scalars; ++k) {
    const int q = span.position_offset + k;
    const int v = span.velocity_offset + k;
    const Range range = RangeOf(v, max_step, bounds);
    scalars_.push_back({q, v,
                        std::max(limits.lower[q], start_[q] + range.lower),
                        std::min(limits.upper[q], start_[q] + range.upper)});
  }
  if (!turns) return;
  const int first = span.velocity_offset + scalars;
  double most = kInfinity;
  for (int k = 0; k < 3; ++k) {
    const Range range = RangeOf(first + k, max_step, bounds);
    most = std::min({most, -range.lower, range.upper});
  }
  // Half a turn and more bounds nothing.
  if (most >= std::numbers::pi) most = kInfinity;
  rotation_at_[first] = static_cast<int>(rotations_.size());
  rotations_.push_back({j,
                        span.quaternion_offset,
                        first,
                        most,
                        false,
                        {Eigen::Matrix3d::Identity(), true}});
}

void StepSpace::MoveTo(const ConstVectorView& positions) {
  for (const Scalar& scalar : scalars_) {
    const double q = positions[scalar.position];
    lower_[scalar.velocity] = std::min(0.0, scalar.lower - q);
    upper_[scalar.velocity] = std::max(0.0, scalar.upper - q);
  }
  for (Rotation& rotation : rotations_) {
    std::fill_n(lower_.begin() + rotation.velocity, 3, -kInfinity);
    std::fill_n(upper_.begin() + rotation.velocity, 3, kInfinity);
    FindBasis(positions, rotation);
    if (rotation.most_turn < kInfinity) BoundTurn(positions, rotation);
  }
}

void StepSpace::BoundTurn(const ConstVectorView& positions,
                          Rotation& rotation) {
  const Eigen::Vector3d turn = LogRotation(
      QuaternionXyzw(start_.data() + rotation.position).conjugate() *
      QuaternionXyzw(positions.data() + rotation.position));
  const double turned = turn.norm();
  Eigen::Vector3d reach = Eigen::Vector3d::Constant(kCube * rotation.most_turn);
  Eigen::Vector3d at = turn;
  if (rotation.based) {
    at = rotation.basis.axes.transpose() * turn;
  } else if (turned > kNoTurn) {
    // The first of its axes along the turn.
    rotation.based = true;
    const Eigen::Vector3d along = turn / turned;
    const Eigen::Vector3d across = along.unitOrthogonal();
    rotation.basis.orthogonal = true;
    rotation.basis.axes << along, across, along.cross(across);
    at = {turned, 0, 0};
    reach = rotation.most_turn * Eigen::Vector3d(kAlong, kAcross, kAcross);
  }
  for (int k = 0; k < 3; ++k) {
    double& lower = lower_[rotation.velocity + k];
    double& upper = upper_[rotation.velocity + k];
    lower = std::max(lower, std::min(0.0, -reach[k] - at[k]));
    upper = std::min(upper, std::max(0.0, reach[k] - at[k]));
  }
}

void StepSpace::FindBasis(const ConstVectorView& positions,
                          Rotation& rotation) {
  const Joint& joint = skeleton_->joint(rotation.joint);
  rotation.based = false;
  if (!joint.limits.HasRotationLimits()) return;
  const Eigen::Quaterniond q =
      QuaternionXyzw(positions.data() + rotation.position);
  const SwingTwist parts = DecomposeSwingTwist(q, joint.axis);
  const double cone = joint.limits.swing_cone_rad.value_or(kInfinity);
  const double swing_room = cone - parts.swing_rad;
  double twist_lower = -kInfinity;
  double twist_upper = kInfinity;
  if (const auto twist = TwistRangeOf(joint.limits)) {
    const double middle = 0.5 * (twist->lower_rad + twist->upper_rad);
    const double from_middle =
        std::remainder(parts.twist_rad - middle, 2 * std::numbers::pi);
    const double reach = 0.5 * (twist->upper_rad - twist->lower_rad);
    twist_lower = std::min(0.0, -reach - from_middle);
    twist_upper = std::max(0.0, reach - from_middle);
  }
  if (swing_room > kNear && twist_lower < -kNear && twist_upper > kNear) return;
  rotation.based = true;
  rotation.basis = {RotationBasis(parts, joint.axis, q), false};
  const int v = rotation.velocity;
  const auto narrow = [&](int k, double lower, double upper) {
    lower_[v + k] = std::max(lower_[v + k], lower);
    upper_[v + k] = std::min(upper_[v + k], upper);
  };
  narrow(0, -kInfinity, std::max(0.0, swing_room));
  narrow(2, twist_lower, twist_upper);
  if (cone > kPointCone) return;
  narrow(0, 0, 0);
  narrow(1, 0, 0);
}

void StepSpace::TurnColumns(LevelStep::MatrixView rows) const {
  for (const Rotation& rotation : rotations_) {
    if (!rotation.based) continue;
    for (int r = 0; r < rows.rows(); ++r) {
      const Eigen::RowVector3d body = rows.block<1, 3>(r, rotation.velocity);
      rows.block<1, 3>(r, rotation.velocity) = body * rotation.basis.axes;
    }
  }
}

const StepSpace::Basis* StepSpace::BasisAt(int first) const {
  const int at = rotation_at_[first];
  return at >= 0 && rotations_[at].based ? &rotations_[at].basis : nullptr;
}

void StepSpace::Move(const double* step, double scale,
                     VectorView positions) const {
  for (const Scalar& scalar : scalars_) {
    double& q = positions[scalar.position];
    q = std::min(std::max(q + scale * step[scalar.velocity], scalar.lower),
                 scalar.upper);
  }
  for (const Rotation& rotation : rotations_) {
    Eigen::Vector3d way =
        scale * Eigen::Map<const Eigen::Vector3d>(step + rotation.velocity);
    if (way.isZero(0)) continue;
    if (rotation.based) way = rotation.basis.axes * way;
    double* quaternion = positions.data() + rotation.position;
    StoreXyzw((QuaternionXyzw(quaternion) * ExpRotation(way)).normalized(),
              quaternion);
    KeepInside(rotation, quaternion);
  }
}

void StepSpace::KeepInside(const Rotation& rotation, double* quaternion) const {
  const Joint& joint = skeleton_->joint(rotation.joint);
  // By turns; limits come last, and hold whatever else was asked for.
  for (int round = 0; round < kBoundRounds; ++round) {
    const bool cut = KeepTurn(rotation, quaternion);
    if (round > 0 && !cut) return;
    const Eigen::Quaterniond turned = QuaternionXyzw(quaternion);
    if (!joint.limits.HasRotationLimits() ||
        RotationLimitExcess(joint.limits, joint.axis, turned) <= 0) {
      return;
    }
    StoreXyzw(ClampRotation(joint.limits, joint.axis, turned), quaternion);
  }
}

bool StepSpace::KeepTurn(const Rotation& rotation, double* quaternion) const {
  if (rotation.most_turn == kInfinity) return false;
  const Eigen::Quaterniond start =
      QuaternionXyzw(start_.data() + rotation.position);
  const Eigen::Vector3d turn =
      LogRotation(start.conjugate() * QuaternionXyzw(quaternion));
  const double angle = turn.norm();
  if (angle <= rotation.most_turn) return false;
  const Eigen::Vector3d kept = (rotation.most_turn / angle) * turn;
  StoreXyzw((start * ExpRotation(kept)).normalized(), quaternion);
  return true;
}

}  // namespace gelenk
