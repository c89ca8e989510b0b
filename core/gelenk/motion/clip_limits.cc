#include "gelenk/motion/clip_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "absl/strings/str_format.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/bone_axes.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {
namespace {

using Positions = Eigen::Ref<const Eigen::MatrixXd>;

constexpr double kHalfTurn = std::numbers::pi;
constexpr double kTurn = 2 * std::numbers::pi;

struct Range {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();

  void Include(double value) {
    lower = std::min(lower, value);
    upper = std::max(upper, value);
  }
  double Width() const { return upper - lower; }
};

// Swing and twist of one joint over the clip.
struct RotationRange {
  double max_swing_rad = 0;
  // Followed over time, moved by whole turns so that its middle is within half
  // a turn of 0.
  Range twist_rad;
};

RotationRange RotationRangeOf(const Positions& positions, int first_row,
                              const Eigen::Vector3d& axis) {
  RotationRange range;
  double twist = 0;
  for (int frame = 0; frame < positions.cols(); ++frame) {
    const SwingTwist parts = DecomposeSwingTwist(
        QuaternionXyzw(positions.col(frame).data() + first_row), axis);
    range.max_swing_rad = std::max(range.max_swing_rad, parts.swing_rad);
    twist += std::remainder(parts.twist_rad - twist, kTurn);
    range.twist_rad.Include(twist);
  }
  const double middle = (range.twist_rad.lower + range.twist_rad.upper) / 2;
  const double turns = kTurn * std::round(middle / kTurn);
  range.twist_rad.lower -= turns;
  range.twist_rad.upper -= turns;
  return range;
}

// The angle among the coordinates of a planar joint.
constexpr int kPlanarAngle = 2;

bool IsAngle(JointType type, int coordinate) {
  return type == JointType::kRevolute ||
         (type == JointType::kPlanar && coordinate == kPlanarAngle);
}

void LimitCoordinates(const Positions& positions, int first_row, int count,
                      const ClipLimitMargins& margins, Joint& joint) {
  for (int k = 0; k < count; ++k) {
    const double margin =
        IsAngle(joint.type, k) ? margins.angle_rad : margins.length_m;
    const auto row = positions.row(first_row + k);
    joint.limits.lower.push_back(row.minCoeff() - margin);
    joint.limits.upper.push_back(row.maxCoeff() + margin);
  }
}

void LimitRotation(const Positions& positions, int first_row, int index,
                   double margin_rad, Joint& joint, ClipLimits& clip) {
  const RotationRange range = RotationRangeOf(positions, first_row, joint.axis);
  const double cone = range.max_swing_rad + margin_rad;
  if (cone < kHalfTurn) joint.limits.swing_cone_rad = cone;
  if (range.max_swing_rad > kMaxSwingWithTwistRad) {
    clip.swinging_half_turn.push_back(index);
  } else if (range.twist_rad.Width() + 2 * margin_rad >= kTurn) {
    clip.twisting_whole_turn.push_back(index);
  } else {
    joint.limits.twist_lower_rad = range.twist_rad.lower - margin_rad;
    joint.limits.twist_upper_rad = range.twist_rad.upper + margin_rad;
  }
}

void ClearPositionLimits(JointLimits& limits) {
  JointLimits kept;
  kept.max_velocity = std::move(limits.max_velocity);
  kept.max_acceleration = std::move(limits.max_acceleration);
  limits = std::move(kept);
}

// `joint` with the limits that the clip gives it.
Joint Limited(const Skeleton& skeleton, int index,
              const Eigen::Vector3d& bone_axis, const Positions& positions,
              const ClipLimitMargins& margins, ClipLimits& clip) {
  Joint joint = skeleton.joint(index);
  const int first_row = skeleton.span(index).position_offset;
  if (first_row < 0) return joint;
  ClearPositionLimits(joint.limits);
  const bool is_root = skeleton.span(index).parent < 0;
  switch (joint.type) {
    case JointType::kFixed:
      break;
    case JointType::kRevolute:
    case JointType::kPrismatic:
    case JointType::kPlanar:
      LimitCoordinates(positions, first_row, PositionCount(joint.type), margins,
                       joint);
      break;
    case JointType::kSpherical:
      joint.axis = bone_axis;
      LimitRotation(positions, first_row, index, margins.angle_rad, joint,
                    clip);
      break;
    case JointType::kFree:
      joint.axis =
          is_root
              ? Eigen::Vector3d(joint.parent_from_joint.rotation.conjugate() *
                                skeleton.up())
              : bone_axis;
      if (!is_root) {
        LimitCoordinates(positions, first_row, 3, margins, joint);
      }
      LimitRotation(positions, first_row + 3, index, margins.angle_rad, joint,
                    clip);
      break;
  }
  return joint;
}

}  // namespace

absl::StatusOr<ClipLimits> LimitToClip(const Skeleton& skeleton,
                                       const Positions& positions,
                                       const ClipLimitMargins& margins) {
  if (positions.cols() == 0) {
    return absl::InvalidArgumentError("positions: want a frame or more, got 0");
  }
  if (positions.rows() != skeleton.position_count()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("positions: want %d rows, got %d",
                        skeleton.position_count(), positions.rows()));
  }
  ClipLimits clip;
  const std::vector<Eigen::Vector3d> bone_axes = BoneAxes(skeleton);
  SkeletonBuilder builder;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    builder.AddJoint(
        Limited(skeleton, i, bone_axes[i], positions, margins, clip));
  }
  for (const EndEffector& effector : skeleton.end_effectors()) {
    builder.AddEndEffector(effector);
  }
  absl::StatusOr<std::shared_ptr<const Skeleton>> limited =
      builder.SetUp(skeleton.up())
          .SetRestPositions(skeleton.rest_positions())
          .Build();
  if (!limited.ok()) return limited.status();
  clip.skeleton = *std::move(limited);
  return clip;
}

}  // namespace gelenk
