#include "gelenk/ik/goals/pose_rows.h"

#include <algorithm>
#include <cmath>

#include "gelenk/ik/goals/direction_rows.h"
#include "gelenk/ik/goals/frame_rows.h"

namespace gelenk {
namespace {

using kernel::GoalShape;

// Of cos^2(swing / 2): where the swing comes this near to half a turn, the
// twist is fading out.
constexpr double kTwistFade = 1e-8;

GoalShape ShapeFor(const AxisMask& rotation_axes) {
  const int count = rotation_axes.count();
  return count == 1 || count == 2 ? GoalShape::kPartialPose : GoalShape::kPose;
}

// The one axis of three that is not like the other two.
Eigen::Vector3d OddAxis(const AxisMask& axes) {
  const bool odd = axes.count() == 1;
  if (axes.x == odd) return Eigen::Vector3d::UnitX();
  return axes.y == odd ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
}

void StoreTranslationRows(const kernel::TaskTarget& target,
                          const kernel::GoalFrame& frame,
                          kernel::GoalRows& rows) {
  rows.position_error2 = 0;
  for (int r = 0; r < target.translation_rows; ++r) {
    const double e = target.world_translation[r] - frame.translation[r];
    rows.residual[r] = e;
    rows.position_error2 += target.row_counts[r] * e * e;
    VelocityRow(rows, 0, r) = Row3::Unit(r);
    AngularRow(rows, 0, r).setZero();
  }
}

// Rotation rows of one angle, about `axis` for small ones.
void StoreTwist(const Eigen::Quaterniond& turn, const Eigen::Vector3d& axis,
                int r, kernel::GoalRows& rows) {
  const double s = turn.vec().dot(axis);
  const double w = turn.w();
  const double swing_cosine2 = s * s + w * w;
  const double fade = swing_cosine2 / (swing_cosine2 + kTwistFade);
  const double angle = 2 * std::atan2(w < 0 ? -s : s, std::abs(w));
  rows.residual[r] = fade * 2 * std::sin(0.5 * angle);
  rows.rotation_error2 = rows.residual[r] * rows.residual[r];
  rows.rotation_energy = AngleEnergy(rows.rotation_error2);
  const Eigen::Vector3d row =
      w * w * axis + w * axis.cross(turn.vec()) + s * turn.vec();
  VelocityRow(rows, 0, r).setZero();
  AngularRow(rows, 0, r) = row / (swing_cosine2 + kTwistFade);
}

// The axis, as the target has it, back to where it belongs.
void StoreTilt(const Eigen::Matrix3d& now, const Eigen::Matrix3d& wanted,
               const Eigen::Vector3d& axis, int r, kernel::GoalRows& rows) {
  const DirectionRows tilt = TurnInto(now * wanted.transpose() * axis, axis);
  rows.rotation_error2 = tilt.residual.squaredNorm();
  rows.rotation_energy = AngleEnergy(rows.rotation_error2);
  for (int k = 0; k < 2; ++k) {
    rows.residual[r + k] = tilt.residual[k];
    VelocityRow(rows, 0, r + k).setZero();
    AngularRow(rows, 0, r + k) = tilt.basis.row(k);
  }
}

}  // namespace

EffectorTask TaskOnEffector(const Skeleton& skeleton, absl::string_view id,
                            GoalShape shape, int translation_rows,
                            int rotation_rows) {
  EffectorTask task;
  task.shape = shape;
  task.translation_rows = translation_rows;
  task.rotation_rows = rotation_rows;
  task.frame_count = 1;
  task.frames[0] = *skeleton.FindEffector(id);
  return task;
}

EffectorTask PoseTask(const Skeleton& skeleton, absl::string_view id,
                      bool translates, const AxisMask& rotation_axes) {
  return TaskOnEffector(skeleton, id, ShapeFor(rotation_axes),
                        translates ? 3 : 0, rotation_axes.count());
}

void StoreScales(GoalShape shape, int translation_rows, int rotation_rows,
                 double rotation_scale, double weight,
                 kernel::TaskTarget& target) {
  const double root = std::sqrt(weight);
  target.shape = shape;
  target.translation_rows = static_cast<int8_t>(translation_rows);
  target.rotation_rows = static_cast<int8_t>(rotation_rows);
  for (int k = 0; k < 3; ++k) {
    target.row_counts[k] = 1;
    target.row_scale[k] = root;
    target.row_scale[3 + k] = root * rotation_scale;
  }
}

void StorePoseRows(bool translates, const AxisMask& axes,
                   const AxisMask& rotation_axes, double rotation_scale,
                   double weight, kernel::TaskTarget& target) {
  const bool turns = rotation_axes.count() > 0;
  StoreScales(ShapeFor(rotation_axes), translates ? 3 : 0,
              rotation_axes.count(), turns ? rotation_scale : 0, weight,
              target);
  const bool counts[3] = {axes.x, axes.y, axes.z};
  for (int k = 0; k < 3; ++k) {
    target.row_counts[k] = counts[k] ? 1 : 0;
    if (!counts[k]) target.row_scale[k] = 0;
  }
  Store(OddAxis(rotation_axes), target.direction);
}

void StoreRotation(const Eigen::Quaterniond& rotation,
                   kernel::TaskTarget& target) {
  Store(rotation.toRotationMatrix(), target.world_rotation);
}

Eigen::Vector3d TurnFromTo(const Eigen::Matrix3d& from,
                           const Eigen::Matrix3d& to) {
  const Eigen::Quaterniond turn(to * from.transpose());
  return (turn.w() < 0 ? -2 : 2) * turn.vec();
}

void LinearizePose(const kernel::TaskTarget& target,
                   const kernel::GoalFrame& frame, kernel::GoalRows& rows) {
  StoreTranslationRows(target, frame, rows);
  rows.rotation_error2 = 0;
  rows.rotation_energy = 0;
  if (target.rotation_rows == 0) return;
  const bool counts = target.row_scale[3] > 0;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  if (counts) {
    turn = TurnFromTo(View(frame.rotation), View(target.world_rotation));
    rows.rotation_error2 = turn.squaredNorm();
    rows.rotation_energy = AngleEnergy(rows.rotation_error2);
  }
  for (int k = 0; k < 3; ++k) {
    const int r = target.translation_rows + k;
    rows.residual[r] = turn[k];
    VelocityRow(rows, 0, r).setZero();
    AngularRow(rows, 0, r) = Row3::Unit(k);
  }
}

void LinearizePartialPose(const kernel::TaskTarget& target,
                          const kernel::GoalFrame& frame,
                          kernel::GoalRows& rows) {
  StoreTranslationRows(target, frame, rows);
  const Eigen::Matrix3d now = View(frame.rotation);
  const Eigen::Matrix3d wanted = View(target.world_rotation);
  const Eigen::Vector3d axis = View(target.direction);
  if (target.rotation_rows == 1) {
    StoreTwist(Eigen::Quaterniond(wanted * now.transpose()), axis,
               target.translation_rows, rows);
  } else {
    StoreTilt(now, wanted, axis, target.translation_rows, rows);
  }
  if (target.row_scale[3] > 0) return;
  // Left free.
  rows.rotation_error2 = 0;
  for (int k = 0; k < target.rotation_rows; ++k) {
    rows.residual[target.translation_rows + k] = 0;
  }
}

}  // namespace gelenk
