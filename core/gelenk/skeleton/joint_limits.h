// How far and how fast one joint may go; everything unset means free.
#ifndef GELENK_SKELETON_JOINT_LIMITS_H_
#define GELENK_SKELETON_JOINT_LIMITS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace gelenk {

struct JointLimits {
  // rad or m, per stored coordinate of revolute, prismatic and planar joints,
  // the three translations of a free joint. Empty, infinite or beyond
  // kLargestNumber means unlimited; lower == upper freezes a coordinate.
  std::vector<double> lower;
  std::vector<double> upper;
  // Spherical and free: largest angle between the joint's axis and its rest
  // direction, rad.
  std::optional<double> swing_cone_rad;
  // Spherical and free: range of the twist about the axis, rad, anywhere in
  // [-2 pi, 2 pi]. See TwistRangeOf.
  std::optional<double> twist_lower_rad;
  std::optional<double> twist_upper_rad;
  // rad/s, m/s and per second squared, per degree of freedom; streams only.
  std::vector<double> max_velocity;
  std::vector<double> max_acceleration;

  bool HasRotationLimits() const {
    return swing_cone_rad.has_value() || twist_lower_rad.has_value() ||
           twist_upper_rad.has_value();
  }
};

struct TwistRange {
  double lower_rad;
  double upper_rad;
};

// The twist range that `limits` set: a side that is not given ends at half a
// turn. None without a side, or where the range is a whole turn or more.
std::optional<TwistRange> TwistRangeOf(const JointLimits& limits);

// By how much `rotation` breaks the swing cone or twist range about `axis`,
// rad; 0 inside.
double RotationLimitExcess(const JointLimits& limits,
                           const Eigen::Vector3d& axis,
                           const Eigen::Quaterniond& rotation);

// The same rotation when inside; else with swing and twist moved to the nearest
// allowed ones, in the hemisphere of `rotation`.
Eigen::Quaterniond ClampRotation(const JointLimits& limits,
                                 const Eigen::Vector3d& axis,
                                 const Eigen::Quaterniond& rotation);

}  // namespace gelenk

#endif  // GELENK_SKELETON_JOINT_LIMITS_H_
