// Keyframes of one part of one joint: what it is at which time, and how it goes
// from one to the next.
#ifndef GELENK_MOTION_JOINT_TRACK_H_
#define GELENK_MOTION_JOINT_TRACK_H_

#include <Eigen/Core>
#include <vector>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/motion/pose_part.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

enum class Interpolation {
  // The key before holds.
  kStep,
  // Straight lines; rotations turn at constant speed the shorter way round.
  kLinear,
  // Cubic Hermite with the tangents given, as glTF's CUBICSPLINE: quaternions
  // are interpolated number by number and normalised.
  kCubicSpline,
  // Cubic through all keys, tangents from the neighbouring keys; rotations
  // likewise, with angular velocities for tangents (see track_curve.h).
  kCatmullRom,
};

absl::string_view InterpolationName(Interpolation interpolation);

struct JointTrack {
  int joint = -1;
  PosePartKind kind = PosePartKind::kRotation;
  Interpolation interpolation = Interpolation::kLinear;
  // From the start of the clip, >= 0, each later than the one before.
  std::vector<double> times_s = {};
  // One column a key: the numbers of the part, or x y z w.
  Eigen::MatrixXd values = {};
  // kCubicSpline only, of the size of `values`: change per second, on the way
  // into and out of each key.
  Eigen::MatrixXd in_tangents = {};
  Eigen::MatrixXd out_tangents = {};

  int key_count() const { return static_cast<int>(times_s.size()); }
};

// Checks `track`, called `field` in messages, and makes its quaternions unit
// and, unless they have tangents, each in the hemisphere of the one before.
// Cost: linear.
void CheckAndNormalize(absl::string_view field, const Skeleton& skeleton,
                       JointTrack& track, Violations& violations);

}  // namespace gelenk

#endif  // GELENK_MOTION_JOINT_TRACK_H_
